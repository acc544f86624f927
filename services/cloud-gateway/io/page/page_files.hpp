// The files of the web page, and the description of the API: they are part of the program.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/base/bytes.hpp"

namespace trb::gateway {

struct PageFile {
  std::string path;  ///< "/assets/index-B91lHiXf.js"
  std::string_view content_type;
  std::string_view cache_control;
  std::string tag;  ///< of the plain bytes: they change, it changes
  std::shared_ptr<const Bytes> plain;
  std::shared_ptr<const Bytes> gzipped;
};

/// All there are; made at the first call.
std::span<const PageFile> page_files();
/// "/" is the page itself.
const PageFile* find_page_file(std::string_view path);

/// By the end of the file's name; empty: a kind of file that no page of ours has.
std::string_view content_type_of(std::string_view path);

}  // namespace trb::gateway
