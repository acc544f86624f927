#include "services/cloud-gateway/io/page/page_files.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/base/embedded_file.hpp"
#include "common/base/hex.hpp"
#include "common/security/keys.hpp"

namespace trb {
std::span<const EmbeddedFile> gateway_page_files();
std::span<const EmbeddedFile> gateway_api_files();
}  // namespace trb

namespace trb::gateway {
namespace {

struct TypeRow {
  std::string_view ending;
  std::string_view type;
};
constexpr std::array kTypes{
    TypeRow{".html", "text/html; charset=utf-8"},
    TypeRow{".js", "text/javascript; charset=utf-8"},
    TypeRow{".css", "text/css; charset=utf-8"},
    TypeRow{".json", "application/json"},
    TypeRow{".svg", "image/svg+xml"},
    TypeRow{".png", "image/png"},
    TypeRow{".woff2", "font/woff2"},
};

/// Those below /assets/ have a hash of their contents in their names.
std::string_view cache_control_of(std::string_view path) {
  return path.starts_with("/assets/") ? "public, max-age=31536000, immutable" : "no-cache";
}

PageFile page_file(const std::string& path, const EmbeddedFile& file) {
  return {path,
          content_type_of(path),
          cache_control_of(path),
          to_hex(digest(file.bytes)).substr(0, 32),
          std::make_shared<const Bytes>(file.bytes),
          std::make_shared<const Bytes>(file.gzipped)};
}

std::vector<PageFile> all_page_files() {
  std::vector<PageFile> out;
  for (const EmbeddedFile& file : gateway_page_files()) out.push_back(page_file("/" + std::string(file.name), file));
  for (const EmbeddedFile& file : gateway_api_files())
    out.push_back(page_file("/api/v1/" + std::string(file.name), file));
  return out;
}

}  // namespace

std::span<const PageFile> page_files() {
  static const std::vector<PageFile> kFiles = all_page_files();
  return kFiles;
}

const PageFile* find_page_file(std::string_view path) {
  const auto files = page_files();
  const auto at = std::ranges::find(files, path == "/" ? "/index.html" : path, &PageFile::path);
  return at == files.end() ? nullptr : &*at;
}

std::string_view content_type_of(std::string_view path) {
  const auto* const row =
      std::ranges::find_if(kTypes, [&](const TypeRow& type) { return path.ends_with(type.ending); });
  return row == kTypes.end() ? std::string_view() : row->type;
}

}  // namespace trb::gateway
