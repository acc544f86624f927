// One device's reader: a thread that reads its sensors, so that a device that hangs holds up nothing else.
#pragma once

#include <memory>

#include "services/sensor-bus/readers/reader_context.hpp"

namespace trb::sensor {

/// Starts the thread; it ends by itself after end(). Errors: queue_full (kMaxReaders threads are there), io_error.
constexpr std::size_t kMaxReaders = 256;
Result<std::shared_ptr<ReaderOrders>> start_reader(const FoundDevice& found, std::uint64_t number,
                                                   const std::shared_ptr<ReaderPool>& pool);

}  // namespace trb::sensor
