#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>

#include "acquisition/live/polhemus_source.h"
#include "acquisition/live/polhemus_usb.h"
#include "acquisition/live/source_address.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr int kDefaultBaud = 115'200;

// The names of "Probe,Reference" as transforms of the tracker.
std::vector<std::string> transforms_of(const SourceAddress& address, const std::string& names) {
  std::vector<std::string> transforms;
  std::set<std::string> seen;
  for (std::size_t from = 0; from <= names.size();) {
    const std::size_t to = std::min(names.find(',', from), names.size());
    const std::string name = names.substr(from, to - from);
    const bool letters =
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) && c < 128; });
    if (name.empty() || !letters || name.size() > 40 || !seen.insert(name).second) {
      address.fail("'stations' must be names of letters and digits with commas between, no two alike, not '" +
                   printable(names) + "'");
    }
    transforms.push_back(name + "ToTracker");
    from = to + 1;
  }
  return transforms;
}

std::unique_ptr<LiveSource> make_from_text(const std::string& source) {
  const SourceAddress address = parse_source(source, {"baud", "distortion", "stations", "text"});
  PolhemusOptions options;
  options.text = address.flag("text");
  options.most_distortion = static_cast<int>(address.number("distortion", options.most_distortion, 0.0, 255.0));
  const auto stations = address.options.find("stations");
  if (stations != address.options.end()) options.transforms = transforms_of(address, stations->second);
  if (address.target == "usb") {
    if (address.options.contains("baud")) address.fail("has no rate on USB; leave 'baud' out");
    return make_polhemus(source, open_polhemus_usb, options);
  }
  if (!address.target.starts_with('/')) address.fail("must be 'usb' or a serial line such as /dev/ttyUSB0");
  const int baud = static_cast<int>(address.number("baud", kDefaultBaud, 1.0, 10'000'000.0));
  const std::string device = address.target;
  return make_polhemus(
      source, [device, baud] { return open_polhemus_serial(device, baud); }, options);
}

// Serial lines are not asked: what is on them may not like it.
void find_serial(std::vector<FoundDevice>& found) {
  std::set<std::string> devices;
  std::error_code fault;
  for (std::filesystem::directory_iterator entry("/dev", fault), end; !fault && entry != end; entry.increment(fault)) {
    const std::string name = entry->path().filename();
    if (name.starts_with("ttyUSB") || name.starts_with("ttyACM")) devices.insert(entry->path());
  }
  for (const std::string& device : devices) {
    found.push_back({"polhemus:" + device, "serial line; a FASTRAK, PATRIOT or LIBERTY, if one is connected to it"});
  }
}

std::vector<FoundDevice> find() {
  std::vector<FoundDevice> found;
  for (const std::string& instrument : find_polhemus_usb()) found.push_back({"polhemus:usb", instrument});
  find_serial(found);
  return found;
}

}  // namespace

void add_polhemus_sources(SourceRegistry& registry) {
  registry.add("polhemus", {"polhemus:usb or polhemus:/dev/ttyUSB0[?baud=115200][&stations=Probe,Reference]"
                            "[&distortion=10][&text=1]",
                            "an electromagnetic tracker: FASTRAK, PATRIOT, LIBERTY", make_from_text, find});
}

}  // namespace fathom
