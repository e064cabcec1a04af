#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/output.h"
#include "core/printable.h"
#include "sim/live_simulation.h"

namespace fathom {

namespace {

void run(bool json) {
  const SourceRegistry sources = all_sources();
  std::vector<FoundDevice> found;
  for (const auto& [name, scheme] : sources.schemes()) {
    for (FoundDevice& device : scheme.find()) found.push_back(std::move(device));
  }
  if (json) {
    nlohmann::ordered_json devices = nlohmann::ordered_json::array();
    for (const FoundDevice& device : found) {
      devices.push_back({{"source", device.source}, {"description", device.description}});
    }
    nlohmann::ordered_json kinds = nlohmann::ordered_json::array();
    for (const auto& [name, scheme] : sources.schemes()) {
      kinds.push_back({{"kind", name}, {"form", scheme.form}, {"description", scheme.description}});
    }
    print_json({{"devices", devices}, {"kinds", kinds}});
    return;
  }
  // Both columns to the left: these are texts.
  const auto print = [](const std::string& source, const std::string& description) {
    constexpr std::size_t kColumn = 32;
    const std::string padding(source.size() < kColumn ? kColumn - source.size() : 2, ' ');
    std::cout << source << padding << printable(description, 200) << "\n";
  };
  std::cout << "found here:\n";
  for (const FoundDevice& device : found) print("  " + device.source, device.description);
  std::cout << "what can be given as a source:\n";
  for (const auto& [name, scheme] : sources.schemes()) print("  " + scheme.form, scheme.description);
}

}  // namespace

void add_devices(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("devices", "List what can be used as a source of images and poses");
  command->add_flag("--json", *json, "Print one JSON object");
  command->callback([json] { run(*json); });
}

}  // namespace fathom
