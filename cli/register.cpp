#include <iostream>
#include <map>
#include <memory>

#include "acquisition/recording.h"
#include "cli/command.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/error.h"
#include "registration/landmark_file.h"
#include "registration/landmark_registration.h"
#include "registration/still_periods.h"

namespace fathom {

namespace {

struct LandmarksCommand {
  std::string from;
  std::string to;
  std::string recording;
  std::vector<double> tip;
  FrameNames names;
  LandmarkOptions match;
  StillOptions still;
  bool in_order = false;
  bool json = false;
};

std::vector<Landmark> rests(const LandmarksCommand& command) {
  const auto recording = open_recording(command.recording);
  const ProbePoses poses = probe_poses(*recording, find_pose_chain(*recording, command.names));
  const Eigen::Vector3d tip(command.tip[0], command.tip[1], command.tip[2]);
  std::vector<Landmark> landmarks;
  for (const StillPeriod& period : still_periods(poses, tip, command.still)) {
    landmarks.push_back({"", period.place_mm});
  }
  return landmarks;
}

std::vector<Eigen::Vector3d> places(const std::vector<Landmark>& landmarks) {
  std::vector<Eigen::Vector3d> result;
  for (const Landmark& landmark : landmarks) result.push_back(landmark.position_mm);
  return result;
}

/// Those that both lists name, as indices into the lists.
std::vector<LandmarkRegistration::Pair> shared_names(const std::vector<Landmark>& from,
                                                     const std::vector<Landmark>& to) {
  std::map<std::string, std::size_t> at;
  for (std::size_t i = 0; i < to.size(); ++i) at[to[i].name] = i;
  std::vector<LandmarkRegistration::Pair> pairs;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto found = at.find(from[i].name);
    if (!from[i].name.empty() && found != at.end()) pairs.push_back({i, found->second, 0.0});
  }
  return pairs;
}

LandmarkRegistration register_pairs(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                                    const std::vector<LandmarkRegistration::Pair>& pairs,
                                    const LandmarkOptions& options) {
  std::vector<Eigen::Vector3d> from_places;
  std::vector<Eigen::Vector3d> to_places;
  for (const LandmarkRegistration::Pair& pair : pairs) {
    from_places.push_back(from[pair.from].position_mm);
    to_places.push_back(to[pair.to].position_mm);
  }
  LandmarkRegistration result = register_landmarks(from_places, to_places, options);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    result.pairs[i].from = pairs[i].from;
    result.pairs[i].to = pairs[i].to;
  }
  return result;
}

LandmarkRegistration registration_of(const std::vector<Landmark>& from, const std::vector<Landmark>& to,
                                     const LandmarksCommand& command) {
  if (command.in_order) {
    if (from.size() != to.size()) {
      throw Error("landmarks: " + std::to_string(from.size()) + " and " + std::to_string(to.size()) +
                  " cannot go together in order; leave out --in-order, so that missing ones are found");
    }
    return register_landmarks(places(from), places(to), command.match);
  }
  const auto named = shared_names(from, to);
  return named.empty() ? match_landmarks(places(from), places(to), command.match)
                       : register_pairs(from, to, named, command.match);
}

std::string verdict(const LandmarkRegistration& fit, std::size_t from_count, std::size_t to_count) {
  constexpr double kGoodMm = 2.0;
  std::string text;
  if (fit.rms_mm > kGoodMm) text += ", touch the landmarks again, more exactly";
  if (fit.pairs.size() == 3) text += ", three landmarks do not show a mistake: add a fourth";
  const std::size_t missed = std::min(from_count, to_count) - fit.pairs.size();
  if (missed > 0) text += ", " + std::to_string(missed) + " of both lists found no partner: check them";
  return (text.empty() ? "good" : "usable") + text;
}

std::string name_of(const std::vector<Landmark>& landmarks, std::size_t index) {
  return landmarks[index].name.empty() ? std::to_string(index + 1) : landmarks[index].name;
}

/// For each landmark of the first list its pair, or nothing.
std::vector<const LandmarkRegistration::Pair*> pair_of_each(const LandmarkRegistration& fit, std::size_t count) {
  std::vector<const LandmarkRegistration::Pair*> pairs(count, nullptr);
  for (const LandmarkRegistration::Pair& pair : fit.pairs) pairs[pair.from] = &pair;
  return pairs;
}

void print_registration_json(const LandmarkRegistration& fit, const std::vector<Landmark>& from,
                             const std::vector<Landmark>& to) {
  nlohmann::ordered_json json;
  auto& numbers = json["transform"] = nlohmann::ordered_json::array();
  for (int i = 0; i < 16; ++i) numbers.push_back(fit.to_from_from.matrix()(i / 4, i % 4));
  json["rms_mm"] = fit.rms_mm;
  json["error_mm"] = fit.error_mm;
  auto& order = json["order"] = nlohmann::ordered_json::array();
  for (const auto* pair : pair_of_each(fit, from.size())) {
    order.push_back(pair != nullptr ? nlohmann::ordered_json(pair->to) : nlohmann::ordered_json(nullptr));
  }
  auto& pairs = json["pairs"] = nlohmann::ordered_json::array();
  for (const LandmarkRegistration::Pair& pair : fit.pairs) {
    pairs.push_back(
        {{"from", name_of(from, pair.from)}, {"to", name_of(to, pair.to)}, {"distance_mm", pair.distance_mm}});
  }
  auto& places_mm = json["to_mm"] = nlohmann::ordered_json::array();
  for (const Landmark& landmark : to) {
    places_mm.push_back(std::vector<double>(landmark.position_mm.begin(), landmark.position_mm.end()));
  }
  json["verdict"] = verdict(fit, from.size(), to.size());
  print_json(json);
}

void print_registration_table(const LandmarkRegistration& fit, const std::vector<Landmark>& from,
                              const std::vector<Landmark>& to) {
  std::vector<std::vector<std::string>> rows{{"landmark", "partner", "distance (mm)"}};
  const auto pairs = pair_of_each(fit, from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    rows.push_back({name_of(from, i), pairs[i] != nullptr ? name_of(to, pairs[i]->to) : "-",
                    pairs[i] != nullptr ? number_text(pairs[i]->distance_mm, 2) : "-"});
  }
  print_table(rows);
  std::cout << "transform:\n";
  std::vector<std::vector<std::string>> matrix(4);
  for (int i = 0; i < 16; ++i) {
    constexpr int kTurnDecimals = 6;
    constexpr int kMmDecimals = 3;
    matrix[static_cast<std::size_t>(i / 4)].push_back(
        number_text(fit.to_from_from.matrix()(i / 4, i % 4), i % 4 < 3 ? kTurnDecimals : kMmDecimals));
  }
  print_table(matrix);
  std::cout << "rms " << number_text(fit.rms_mm, 2) << " mm over " << fit.pairs.size() << " landmarks\n"
            << "verdict: " << verdict(fit, from.size(), to.size()) << "\n";
}

void run(const LandmarksCommand& command) {
  const std::vector<Landmark> from = read_landmarks(command.from);
  const std::vector<Landmark> to = command.to.empty() ? rests(command) : read_landmarks(command.to);
  const LandmarkRegistration fit = registration_of(from, to, command);
  (command.json ? print_registration_json : print_registration_table)(fit, from, to);
}

void add_landmarks(CLI::App& app) {
  auto options = std::make_shared<LandmarksCommand>();
  options->names.probe = "Stylus";
  CLI::App* command = app.add_subcommand("landmarks", "Find the rigid motion that takes landmarks to where they are");
  command->add_option("--from", options->from, "Landmarks as CSV: x,y,z or name,x,y,z in mm")->required();
  auto* to = command->add_option("--to", options->to, "The same landmarks in the coordinates to go to");
  auto* recording = command->add_option("--to-recording", options->recording,
                                        "Instead: a recording of a pointer held still on one after the other");
  auto* tip = command->add_option("--tip", options->tip, "The pointer's tip in its own coordinates, mm")
                  ->delimiter(',')
                  ->expected(3)
                  ->check(finite());
  command->add_option("--tool,--probe-frame", options->names.probe, "Name of the pointer's coordinates")
      ->capture_default_str();
  command->add_option("--reference-frame", options->names.reference,
                      "Name of the coordinates to go to (default: Reference, else Tracker)");
  command->add_option("--rest-s", options->still.min_duration_s, "The pointer rests for at least so long")
      ->check(above(0))
      ->capture_default_str();
  command
      ->add_option("--tolerance-mm", options->match.tolerance_mm,
                   "By how much distances between landmarks may differ when their order is looked for")
      ->check(above(0))
      ->capture_default_str();
  command->add_option("--max-rms-mm", options->match.max_rms_mm, "Landmarks that fit worse are refused")
      ->check(above(0))
      ->capture_default_str();
  command->add_flag("--in-order", options->in_order, "Both lists have the same landmarks in the same order");
  command->add_flag("--json", options->json, "Print one JSON object");
  to->excludes(recording);
  recording->needs(tip);
  tip->needs(recording);
  command->callback([options] {
    if (options->to.empty() == options->recording.empty()) {
      throw CLI::RequiredError("one of --to and --to-recording");
    }
    run(*options);
  });
}

}  // namespace

void add_register(CLI::App& app) {
  CLI::App* command = app.add_subcommand("register", "Find how two coordinate systems lie to each other");
  command->require_subcommand(1);
  add_landmarks(*command);
}

}  // namespace fathom
