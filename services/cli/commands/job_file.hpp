// A file with JSON in it as a key of a job.
#pragma once

#include "proto/value.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// Nothing if the option was not given. Errors: of the file, and malformed.
Status add_file(Value::Object& job, const Arguments& arguments, const char* option, const char* key);

/// As a file, if there is one of that name; else as a text.
Status add_name_or_file(Value::Object& job, const Arguments& arguments, const char* option, const char* key);

/// "a,b" becomes a list of texts. Nothing if the option was not given.
void add_list(Value::Object& job, const Arguments& arguments, const char* option, const char* key);

}  // namespace trb::cli
