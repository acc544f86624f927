#include "services/cli/commands/model_terms.hpp"

#include <cstdlib>

namespace trb::cli {

namespace {

constexpr std::uint64_t kMostWhole = INT64_MAX;  ///< a job's numbers are signed

}  // namespace

void OptionReader::refuse(const std::string& option, const std::string& wanted, const std::string& hint) {
  if (!status_.ok()) return;
  status_ = fail(Errc::bad_value, option + ": '" + arguments_.get(option) + "' is no " + wanted, hint);
}

void OptionReader::read(const std::string& option, std::uint64_t& into) {
  if (!arguments_.has(option)) return;
  const std::string text = arguments_.get(option);
  const bool digits = !text.empty() && text.size() <= 19 && text.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || std::stoull(text) > kMostWhole)
    return refuse(option, "whole number that is taken", "use one from 0 to " + std::to_string(kMostWhole));
  into = std::stoull(text);
}

void OptionReader::read(const std::string& option, double& into) {
  if (!arguments_.has(option)) return;
  const std::string text = arguments_.get(option);
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(number) || number < 0)
    return refuse(option, "number from 0", "use 0 or more");
  into = number;
}

const std::vector<ModelTerm>& model_terms() {
  static const std::vector<ModelTerm> kTerms = {
      {"boot", "1", "3n + 1", model::boot},
      {"identification", "2", "n(n + 1) / 2", model::identification},
      {"devices", "3", "2s + delta_t sum x_i", model::devices},
      {"start", "4", "(1) + (2) + (3)", model::start},
      {"task", "7", "4 N_d + 8 N_i", model::task},
      {"forward", "8", "N_d + N_i - sum m_j + k - 1", model::forward},
      {"scenario", "9", "(7) + (8)", model::scenario},
      {"sensor", "10", "2 R_l + 4 R_e", model::sensor},
      {"fail", "11", "2 N_f", model::failures},
      {"total", "12", "(4) + (9) + (10) + (11)", model::total},
  };
  return kTerms;
}

std::string shown_number(double number) {
  char out[32];
  std::snprintf(out, sizeof out, std::floor(number) == number ? "%.0f" : "%.3f", number);
  return out;
}

std::vector<std::string> with_model_options(std::vector<std::string> options) {
  const std::vector<std::string> alike = {
      "--sensors N|devices in the fleet (0)",
      "--rate X|updates that each of them sends in a second (1)",
      "--local-requests N|requests to a sensor of the robot that asks (0)",
      "--remote-requests N|requests to a sensor of another robot (0)",
      "--faulty N|robots that fail, at most all but one (0)",
  };
  options.insert(options.end(), alike.begin(), alike.end());
  return options;
}

}  // namespace trb::cli
