#include "sim/laboratory/study_results.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <utility>

#include "core/error.h"
#include "core/json.h"
#include "core/printable.h"

namespace fathom {

namespace {

constexpr const char* kMarker = "fathom_accuracy";
constexpr int kFormat = 1;
constexpr int kMostCases = 10'000'000;
constexpr std::size_t kMostNamed = 8;  // in a message

std::optional<int> whole(std::string_view text) {
  int value = 0;
  const auto [rest, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc() || rest != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

const Study& study_of_file(const JsonValue& name) {
  try {
    return study_of(printable(name.string()));
  } catch (const Error& error) {
    name.fail(error.what());
  }
}

Shard read_shard(const JsonValue& value) {
  if (value.size() != 2) value.fail("must be two numbers: which part, of how many");
  Shard shard;
  shard.count = value[1].integer(1, kMostShards);
  shard.index = value[0].integer(0, shard.count - 1);
  return shard;
}

void read_values(const JsonValue& list, StudyResults& results) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    const JsonValue number = list[i].at("case");
    const int index = number.integer(0, results.cases - 1);
    if (!results.shard.holds(index)) number.fail("is not in this part of the study");
    const bool added = results.values.emplace(index, list[i].at("value").raw()).second;
    if (!added) number.fail("is there twice");
  }
  const int expected = (results.cases - results.shard.index + results.shard.count - 1) / results.shard.count;
  if (static_cast<int>(results.values.size()) < expected) {
    list.fail("has the results of " + std::to_string(results.values.size()) +
              " cases, but this part of the study has " + std::to_string(expected) + "; run it again");
  }
}

std::string name_of(const StudyResults& part) { return part.source.empty() ? results_file_name(part) : part.source; }

void require_same(const StudyResults& first, const StudyResults& other) {
  const auto refuse = [&](const std::string& what, const std::string& one, const std::string& two) {
    throw Error(name_of(other) + ": is of " + what + " " + two + ", but " + name_of(first) + " is of " + what + " " +
                one + "; merge only parts of one run");
  };
  if (first.study != other.study) refuse("study", first.study, other.study);
  if (first.version != other.version) refuse("version", first.version, other.version);
  if (first.build != other.build) refuse("build", first.build, other.build);
  if (first.options.samples != other.options.samples) {
    refuse("samples", std::to_string(first.options.samples), std::to_string(other.options.samples));
  }
  if (first.options.seed != other.options.seed) {
    refuse("seed", std::to_string(first.options.seed), std::to_string(other.options.seed));
  }
  if (first.cases != other.cases) refuse("cases", std::to_string(first.cases), std::to_string(other.cases));
}

// Where all parts were made by one division, the missing ones have names; else the missing cases are listed.
[[noreturn]] void complain_of_missing(const std::vector<StudyResults>& parts, const StudyResults& joined) {
  const int count = parts.front().shard.count;
  const bool one_division =
      std::all_of(parts.begin(), parts.end(), [&](const StudyResults& part) { return part.shard.count == count; });
  std::set<int> missing;
  for (int i = 0; i < joined.cases; ++i) {
    if (!joined.values.contains(i)) missing.insert(one_division ? i % count : i);
  }
  std::string names;
  std::size_t named = 0;
  for (const int one : missing) {
    if (named == kMostNamed) break;
    names += (named++ == 0 ? "" : ", ") + std::to_string(one) + (one_division ? "/" + std::to_string(count) : "");
  }
  if (missing.size() > kMostNamed) names += ", ...";
  throw Error(name_of(parts.front()) + ": " + std::string(one_division ? "shards " : "cases ") + names + " of study " +
              joined.study + " are missing among the files given; run them and add their files");
}

}  // namespace

Shard parse_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const auto index = whole(std::string_view(text).substr(0, slash));
    const auto count = whole(std::string_view(text).substr(slash + 1));
    if (index && count && *index < *count && *count <= kMostShards) return {*index, *count};
  }
  throw Error(printable(text) + " is no part of a whole; give I/N with I from 0 to N - 1, such as 0/3");
}

std::string results_file_name(const StudyResults& results) {
  const Shard& shard = results.shard;
  const std::string part =
      shard.whole() ? "" : ".shard-" + std::to_string(shard.index) + "-of-" + std::to_string(shard.count);
  return results.study + part + ".json";
}

std::string results_text(const StudyResults& results) {
  nlohmann::ordered_json json;
  json[kMarker] = kFormat;
  json["version"] = results.version;
  json["build"] = results.build;
  json["study"] = results.study;
  json["samples"] = results.options.samples;
  json["seed"] = results.options.seed;
  json["cases"] = results.cases;
  json["shard"] = {results.shard.index, results.shard.count};
  std::string text = json.dump(1, ' ');
  // A line for each case, so that files can be compared by eye.
  text.replace(text.rfind('\n'), std::string::npos, ",\n \"results\": [");
  const char* separator = "\n";
  for (const auto& [index, value] : results.values) {
    text += separator + nlohmann::ordered_json{{"case", index}, {"value", value}}.dump();
    separator = ",\n";
  }
  return text + "\n ]\n}\n";
}

StudyResults read_results(const std::filesystem::path& file) {
  const nlohmann::json document = JsonValue::read_file(file);
  const JsonValue root(document, file);
  require_version(root, kMarker, kFormat);
  StudyResults results;
  results.source = file.string();
  results.version = printable(root.at("version").string());
  results.build = printable(root.at("build").string());
  const Study& study = study_of_file(root.at("study"));
  results.study = study.name();
  results.options.samples = root.at("samples").integer(1, kMostSamples);
  results.options.seed = root.at("seed").whole_number();
  results.cases = root.at("cases").integer(1, kMostCases);
  results.shard = read_shard(root.at("shard"));
  read_values(root.at("results"), results);
  return results;
}

StudyResults merged(const std::vector<StudyResults>& parts) {
  StudyResults joined = parts.front();
  joined.shard = {};
  joined.source.clear();
  std::map<int, const StudyResults*> origin;
  for (const auto& [index, value] : parts.front().values) origin[index] = &parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i) {
    require_same(parts.front(), parts[i]);
    for (const auto& [index, value] : parts[i].values) {
      if (!joined.values.emplace(index, value).second) {
        throw Error(name_of(parts[i]) + ": case " + std::to_string(index) + " of study " + joined.study + " is in " +
                    name_of(*origin[index]) + " too; give every part once");
      }
      origin[index] = &parts[i];
    }
  }
  if (!joined.complete()) complain_of_missing(parts, joined);
  return joined;
}

std::vector<nlohmann::ordered_json> values_in_order(const StudyResults& results) {
  std::vector<nlohmann::ordered_json> values;
  values.reserve(results.values.size());
  for (const auto& [index, value] : results.values) values.push_back(value);
  return values;
}

}  // namespace fathom
