#include "io/bounded_json.h"

#include <string>

#include <gtest/gtest.h>

#include "io/ordered_json.h"

namespace cbmv {
namespace {

using Json = OrderedJson;
using Event = nlohmann::json::parse_event_t;

std::string brackets(int depth) { return std::string(depth, '[') + std::string(depth, ']'); }

std::string object(int keys) {
  std::string text = "{";
  for (int i = 0; i < keys; ++i) {
    text += (i == 0 ? "\"" : ",\"") + std::to_string(i) + "\":0";
  }
  return text + "}";
}

TEST(ParseBounded, ReadsWhatIsInside) {
  EXPECT_EQ(parseBounded<Json>(R"({"b": [1, 2.5, "x"], "a": null})").dump(),
            R"({"b":[1,2.5,"x"],"a":null})");
  EXPECT_THROW(parseBounded<Json>("[1"), Json::parse_error);
}

TEST(ParseBounded, BoundsTheDepth) {
  EXPECT_NO_THROW(parseBounded<Json>(brackets(JsonBounds::kMaxDepth)));
  EXPECT_THROW(parseBounded<Json>(brackets(JsonBounds::kMaxDepth + 1)), JsonTooLarge);
}

/// The limit applies to each object.
TEST(ParseBounded, BoundsTheKeysOfAnObject) {
  const std::string largest = object(JsonBounds::kMaxKeys);
  EXPECT_NO_THROW(parseBounded<Json>("[" + largest + "," + largest + "]"));
  EXPECT_THROW(parseBounded<Json>(object(JsonBounds::kMaxKeys + 1)), JsonTooLarge);
}

TEST(JsonBounds, BoundsTheValues) {
  JsonBounds bounds;
  for (long i = 0; i < JsonBounds::kMaxValues; ++i) {
    bounds.count(1, Event::value);
  }
  EXPECT_THROW(bounds.count(1, Event::value), JsonTooLarge);
}

}  // namespace
}  // namespace cbmv
