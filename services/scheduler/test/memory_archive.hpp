// The journal in memory, by the names of the tests.
#pragma once

#include "services/scheduler/core/memory_journal.hpp"
#include "services/scheduler/io/journal.hpp"

namespace trb::scheduler::test {

using scheduler::MemoryArchive;
using scheduler::MemoryJournal;

}  // namespace trb::scheduler::test
