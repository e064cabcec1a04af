#include "cli/options.h"

#include <charconv>
#include <cstdint>
#include <utility>

#include "core/numbers.h"
#include "segmentation/contours.h"

namespace fathom {

namespace {

// A validator says what is wrong, or nothing.
const std::string kAccepted;

}  // namespace

void add_frame_names(CLI::App& command, FrameNames& names) {
  command.add_option("--probe-frame", names.probe, "Name of the probe's coordinates in the recording (default: Probe)");
  command.add_option("--reference-frame", names.reference,
                     "Name of the coordinates to work in (default: Reference, else Tracker)");
}

CLI::Option* add_number_lists(CLI::App& command, const std::string& name, std::vector<std::vector<double>>& lists,
                              std::size_t count, const std::string& form, const std::string& help) {
  const auto read = [&lists, name, count, form](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) {
      std::string spaced = text;
      for (char& c : spaced) c = c == ',' ? ' ' : c;
      auto numbers = parse_reals(spaced);
      if (!numbers || numbers->size() != count) {
        throw CLI::ValidationError(name, text + " is not " + std::to_string(count) + " numbers: " + form);
      }
      lists.push_back(std::move(*numbers));
    }
  };
  return command.add_option_function<std::vector<std::string>>(name, read, help)->expected(1)->take_all();
}

CLI::Validator finite() {
  return CLI::Validator(
      [](std::string& text) { return parse_real(text) ? kAccepted : std::string("must be a finite number"); }, "");
}

CLI::Validator at_least(double low) {
  return CLI::Validator(
      [low](std::string& text) {
        const auto value = parse_real(text);
        return value && *value >= low ? kAccepted : "must be a number of at least " + format_real(low);
      },
      ">=" + format_real(low));
}

CLI::Validator above(double low) {
  return CLI::Validator(
      [low](std::string& text) {
        const auto value = parse_real(text);
        return value && *value > low ? kAccepted : "must be a number above " + format_real(low);
      },
      ">" + format_real(low));
}

CLI::Validator between(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) {
        const auto value = parse_real(text);
        return value && *value >= low && *value <= high
                   ? kAccepted
                   : "must be a number from " + format_real(low) + " to " + format_real(high);
      },
      "in [" + format_real(low) + ", " + format_real(high) + "]");
}

CLI::Validator whole_number() {
  return CLI::Validator(
      [](std::string& text) {
        std::uint64_t value = 0;
        const char* const end = text.data() + text.size();
        const auto [stop, code] = std::from_chars(text.data(), end, value);
        return code == std::errc() && stop == end ? kAccepted
                                                  : std::string("must be a whole number from 0 to 2^64 - 1");
      },
      "");
}

CLI::Validator png_name() {
  return CLI::Validator([](std::string& text) { return text.ends_with(".png") ? kAccepted : "must end in .png"; }, "");
}

CLI::Validator structure_name() {
  return CLI::Validator([](std::string& text) { return name_fault(text).value_or(kAccepted); }, "");
}

}  // namespace fathom
