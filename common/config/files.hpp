// Files are read and written by common/base/files.hpp, which also implements them (base/files.cpp): nothing to add
// here.
#pragma once

#include "common/base/files.hpp"
