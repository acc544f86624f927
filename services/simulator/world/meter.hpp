// What has been sent: counted by phase, and mixed into a digest by which two runs are compared.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "proto/bodies/link.hpp"
#include "services/simulator/counting/tally.hpp"

namespace trb::world {

struct Sending {
  double at_s = 0;
  std::string_view from, to;
  std::string_view subtype;
  std::uint64_t bytes = 0;
  bool between_computers = false;
};

class Meter {
 public:
  explicit Meter(double seconds) : tally_(seconds) {}

  /// Of a connection, before its first message: bytes of the wire, and no message.
  void on_connection(double at_s, std::uint64_t bytes) {
    ++connections_;
    tally_.add_bytes(at_s, phase_of(Hello::kSubtype), bytes);
  }

  void on(const Sending& sending, std::string_view frame) {
    const CostPhase phase = phase_of(sending.subtype);
    tally_.add(sending.at_s, phase, sending.bytes, sending.between_computers);
    mix(sending.from);
    mix(sending.to);
    mix(std::string_view(reinterpret_cast<const char*>(&sending.at_s), sizeof sending.at_s));
    mix(frame);
    frame_ = frame;
    if (watch) watch(sending, frame);
    if (trace) trace(sending, phase);
    frame_ = {};
  }
  /// Of the message that `watch` and `trace` are being told of; empty: none.
  [[nodiscard]] std::string_view frame() const { return frame_; }
  [[nodiscard]] const counting::Tally& tally() const { return tally_; }
  [[nodiscard]] std::uint64_t connections() const { return connections_; }
  /// FNV-1a of every message, its ends and its time.
  [[nodiscard]] std::uint64_t digest() const { return digest_; }

  std::function<void(const Sending&, CostPhase)> trace;
  std::function<void(const Sending&, std::string_view frame)> watch;

 private:
  void mix(std::string_view bytes) {
    for (const char byte : bytes) digest_ = (digest_ ^ static_cast<unsigned char>(byte)) * 0x100000001B3U;
    digest_ = (digest_ ^ bytes.size()) * 0x100000001B3U;
  }

  counting::Tally tally_;
  std::string_view frame_;
  std::uint64_t connections_ = 0;
  std::uint64_t digest_ = 0xCBF29CE484222325U;
};

}  // namespace trb::world
