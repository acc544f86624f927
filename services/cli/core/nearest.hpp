#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trb::cli {

/// How many letters must be put in, left out, exchanged for another or swapped with the next to make one of the other
/// (the optimal string alignment distance). Time and memory grow with the product of the lengths: for words.
std::size_t edits_between(std::string_view a, std::string_view b);

/// The word that was probably meant: the nearest, if a third of its letters are wrong at most; the first of several.
/// Empty: none.
std::string nearest(std::string_view given, const std::vector<std::string>& known);

}  // namespace trb::cli
