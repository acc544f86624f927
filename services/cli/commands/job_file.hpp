// A file with JSON in it as a key of a job.
#pragma once

#include "proto/value.hpp"
#include "services/cli/core/arguments.hpp"

namespace trb::cli {

/// Nothing if the option was not given. Errors: of the file, and malformed.
Status add_file(Value::Object& job, const Arguments& arguments, const char* option, const char* key);

/// --link: as a file, if there is one of that name; else the name of a kind. Errors: of the file; bad_value.
Status add_link(Value::Object& job, const Arguments& arguments);

/// "a,b" becomes a list of texts. Nothing if the option was not given.
void add_list(Value::Object& job, const Arguments& arguments, const char* option, const char* key);

}  // namespace trb::cli
