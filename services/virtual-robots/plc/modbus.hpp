#pragma once

#include <string>
#include <string_view>

#include "services/virtual-robots/plc/memory.hpp"

namespace trb::virtual_robots::plc {

/** The answer to a request's PDU (function code and what follows it): done, or an exception. Never empty. */
std::string answer_pdu(std::string_view pdu, Memory& memory);

/** Splits the bytes of one client into requests and answers each. */
class Intake {
 public:
  /** The answers to the requests that have become complete, in order. */
  std::string take(std::string_view bytes, Memory& memory);

  /** True for bytes that are not Modbus TCP: the stream cannot be resynchronised, so the client must be dropped. */
  bool broken() const { return broken_; }

 private:
  std::string bytes_;
  bool broken_ = false;
};

}  // namespace trb::virtual_robots::plc
