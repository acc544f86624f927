// What the readers of both codecs share: the first fault and where in the body it is, and how a field of each kind is
// read.
#pragma once

#include <string>
#include <string_view>

#include "common/base/result.hpp"
#include "proto/make_shape.hpp"

namespace trb {

/// `Reader` derives from it, and has a `take_...` for what a `From` of the wire may be; each returns false and sets
/// `error`.
template <class Reader, class From>
struct FieldReader {
  std::string path;
  Error error;

  bool take(const Shape& shape, const From& from, void* out, std::uint32_t max) {
    auto& reader = static_cast<Reader&>(*this);
    switch (shape.kind) {
      case FieldKind::boolean:
        return reader.take_bool(from, as<bool>(out));
      case FieldKind::enumeration:
        return reader.take_enum(shape.names, from, as<std::uint8_t>(out));
      case FieldKind::uint16:
        return reader.take_integer(from, as<std::uint16_t>(out));
      case FieldKind::uint32:
        return reader.take_integer(from, as<std::uint32_t>(out));
      case FieldKind::uint64:
        return reader.take_integer(from, as<std::uint64_t>(out));
      case FieldKind::int64:
        return reader.take_integer(from, as<std::int64_t>(out));
      case FieldKind::number:
        return reader.take_double(from, as<double>(out));
      case FieldKind::text:
        return reader.take_text(from, as<std::string>(out), max);
      case FieldKind::blob:
        return reader.take_blob(from, as<Blob>(out), max);
      case FieldKind::list:
        return reader.take_list(shape.list, from, out, max);
      case FieldKind::record:
        break;
    }
    return reader.take_fields(shape.fields, from, out);
  }

 protected:
  bool refuse(Errc code, std::string_view what) {
    if (error.code == Errc::ok)
      error = fail(code, (path.empty() ? std::string("body") : path) + ": " + std::string(what));
    return false;
  }
};

}  // namespace trb
