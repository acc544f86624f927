// A new node's folder, made from the shipped examples: whole or not at all.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "services/cli/core/new_node.hpp"

namespace trb::cli {

/// The shipped examples: of TRB_CONFIG, beside the installed programs, or in the source tree that built this one.
/// Errors: missing.
Result<std::string> config_dir();

/// Whether the folder is a node's, or may be one. Errors: missing, with `hint`; io_error if this user may not look into
/// it.
Status find_node_json(const std::string& dir, const std::string& hint);

/// These files of the folder of examples, under the same names. Errors: missing, io_error.
Status copy_examples(const std::string& config, const std::vector<std::string>& names, const std::string& dir);

/// The path without "." in it and without a slash at its end, so that a name beside the folder's can be made of it.
std::string plain_folder(const std::string& path);

/// The folders in which a call that was killed had begun to make this one: their private keys are for nobody's use.
std::vector<std::string> unfinished_folders(const std::string& dir);
/// What a person is told of one.
std::string note_of_unfinished(const std::string& folder);

/// Makes the folder beside itself first: whoever stops this half way finds no half folder. What others that were killed
/// have left is named on standard error. Errors: conflict (it has files), io_error, those of `write`; then nothing is
/// left of it.
Status make_whole_folder(const std::string& dir, const std::function<Status(const std::string& making)>& write);

/// A robot's node with its keys, in a folder that is not there yet or empty. Errors: conflict (it has files), missing,
/// io_error; then nothing is left of it.
Status make_node_folder(const NewNode& node, const std::string& dir, const std::string& config);

/// The same of a cloud node.
Status make_cloud_folder(const NewCloud& cloud, const std::string& dir, const std::string& config);

}  // namespace trb::cli
