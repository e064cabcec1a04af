#include "core/json.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/scratch_folder.h"

namespace fathom {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

/// What JsonValue says when `ask` is asked of the document `text` in exam.json; empty when nothing is wrong.
template <typename Ask>
std::string complaint(const std::string& text, Ask ask) {
  const auto document = nlohmann::json::parse(text);
  return message_of<Error>([&] { ask(JsonValue(document, "exam.json")); });
}

/// What reading a file of this content says.
std::string reading(const std::string& content) {
  const ScratchFolder folder;
  put(folder / "a.json", content);
  return message_of<Error>([&] { JsonValue::read_file(folder / "a.json"); });
}

TEST(JsonValue, GivesBackWhatTheFileHolds) {
  const ScratchFolder folder;
  put(folder / "a.json", R"({"structures": [{"name": "Blase \u00e4", "frame": 12, "closed": false, "mm": -2.5e-3}]})");
  const auto document = JsonValue::read_file(folder / "a.json");
  const JsonValue structures = JsonValue(document, folder / "a.json").at("structures");
  ASSERT_EQ(structures.size(), 1u);
  EXPECT_EQ(structures[0].at("name").string(), "Blase \xc3\xa4");
  EXPECT_EQ(structures[0].at("frame").integer(0, 100), 12);
  EXPECT_FALSE(structures[0].at("closed").boolean());
  EXPECT_EQ(structures[0].at("mm").number(), -0.0025);
  EXPECT_FALSE(structures[0].has("color"));
}

TEST(JsonValue, SaysWhereInTheFileTheFaultLies) {
  const std::string text = R"({"structures": [{"name": "a"}, {"name": 7}]})";
  EXPECT_THAT(complaint(text, [](const JsonValue& root) { root.at("structures")[1].at("name").string(); }),
              StartsWith("exam.json: structures[1].name: must be a text"));
  EXPECT_THAT(complaint(text, [](const JsonValue& root) { root.at("structures")[0].at("contours"); }),
              AllOf(StartsWith("exam.json: structures[0]: "), HasSubstr("\"contours\" is missing")));
  EXPECT_THAT(complaint(text, [](const JsonValue& root) { root.at("structures")[2]; }),
              StartsWith("exam.json: structures: has no element 2"));
}

TEST(JsonValue, RefusesAValueOfAnotherType) {
  const auto is_refused = [](const std::string& value, auto ask) {
    return !complaint("{\"v\": " + value + "}", [&](const JsonValue& root) { ask(root.at("v")); }).empty();
  };
  for (const std::string value : {"null", "true", "[]", "{}", "\"1\""}) {
    EXPECT_TRUE(is_refused(value, [](const JsonValue& v) { v.number(); })) << value;
    EXPECT_TRUE(is_refused(value, [](const JsonValue& v) { v.integer(-10, 10); })) << value;
  }
  for (const std::string value : {"null", "true", "[]", "{}", "1"}) {
    EXPECT_TRUE(is_refused(value, [](const JsonValue& v) { v.string(); })) << value;
  }
  for (const std::string value : {"null", "1", "[]", "{}", "\"true\""}) {
    EXPECT_TRUE(is_refused(value, [](const JsonValue& v) { v.boolean(); })) << value;
  }
  for (const std::string value : {"null", "1", "{}", "\"a\""}) {
    EXPECT_TRUE(is_refused(value, [](const JsonValue& v) { v.size(); })) << value;
    EXPECT_TRUE(is_refused(value, [](const JsonValue& v) { v[0]; })) << value;
  }
  for (const std::string value : {"null", "1", "[]", "\"a\""}) {
    EXPECT_TRUE(is_refused(value, [](const JsonValue& v) { v.at("a"); })) << value;
  }
}

TEST(JsonValue, TakesWholeNumbersWithinTheirRangeOnly) {
  const auto integer = [](const std::string& value) {
    return complaint("{\"frame\": " + value + "}", [](const JsonValue& root) { root.at("frame").integer(0, 189); });
  };
  EXPECT_EQ(integer("0"), "");
  EXPECT_EQ(integer("189"), "");
  EXPECT_EQ(integer("12.0"), "");
  EXPECT_THAT(integer("190"), HasSubstr("exam.json: frame: must lie between 0 and 189"));
  EXPECT_THAT(integer("-1"), HasSubstr("between 0 and 189"));
  EXPECT_THAT(integer("1e300"), HasSubstr("between 0 and 189"));
  EXPECT_THAT(integer("99999999999999999999"), HasSubstr("between 0 and 189"));
  EXPECT_THAT(integer("1.5"), HasSubstr("whole number"));
}

TEST(JsonFile, MustBeCompleteAndFinite) {
  EXPECT_EQ(reading("{\"a\": [1, 2]}"), "");
  for (const std::string content : {"", " ", "{\"a\": [1, 2", "{\"a\": [1, 2]} x", "{'a': 1}", "[1e999]", "[NaN]",
                                    "[Infinity]", "\x89PNG\r\n", "[\"\xff\xfe\"]", "[\"a\nb\"]"}) {
    EXPECT_THAT(reading(content), AllOf(HasSubstr("a.json: "), HasSubstr("JSON"))) << content;
  }
}

TEST(JsonFile, IsRefusedBeforeItTakesMemory) {
  EXPECT_THAT(reading(std::string(20 << 20, '[')), HasSubstr("nests deeper"));
  std::string many = "[0";
  for (int i = 0; i < 7000000; ++i) many += ",0";
  EXPECT_THAT(reading(many + "]"), HasSubstr("million values"));
  // Inside a text, brackets and commas are only letters.
  EXPECT_EQ(reading("[\"" + std::string(1000, '[') + std::string(7000000, ',') + "\\\"[\"]"), "");
}

TEST(JsonFile, MustBeThere) {
  const ScratchFolder folder;
  EXPECT_THAT(message_of<Error>([&] { JsonValue::read_file(folder / "no.json"); }), HasSubstr("does not exist"));
  std::filesystem::create_directory(folder / "dir.json");
  EXPECT_THAT(message_of<Error>([&] { JsonValue::read_file(folder / "dir.json"); }), HasSubstr("is not a file"));
}

TEST(JsonFile, MayNotBeHuge) {
  const ScratchFolder folder;
  put(folder / "huge.json", "");
  std::filesystem::resize_file(folder / "huge.json", std::uintmax_t{1} << 40);
  EXPECT_THAT(message_of<Error>([&] { JsonValue::read_file(folder / "huge.json"); }), HasSubstr("MB"));
}

TEST(JsonFile, OfAnotherKindOrVersionIsRefused) {
  const auto version = [](const std::string& text) {
    return complaint(text, [](const JsonValue& root) { require_version(root, "fathom_contours", 1); });
  };
  EXPECT_EQ(version(R"({"fathom_contours": 1})"), "");
  EXPECT_THAT(version(R"({"fathom_calibration": 1})"), HasSubstr("no \"fathom_contours\""));
  EXPECT_THAT(version(R"({"fathom_contours": 2})"), HasSubstr("version 2"));
  EXPECT_THAT(version(R"({"fathom_contours": "1"})"), HasSubstr("must be a number"));
  EXPECT_THAT(version("[1]"), HasSubstr("must be an object"));
}

}  // namespace
}  // namespace fathom
