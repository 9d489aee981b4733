#include "io/ordered_json.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

namespace cbmv {
namespace {

TEST(OrderedJson, KeepsTheOrderOfTheKeys) {
  OrderedJson json = {{"z", 1}, {"a", {{"y", 2}, {"b", nullptr}}}};
  json["m"] = 3;
  json.push_back({"c", 4});
  EXPECT_EQ(json.dump(), R"({"z":1,"a":{"y":2,"b":null},"m":3,"c":4})");
  EXPECT_EQ(OrderedJson::parse(json.dump()).dump(), json.dump());
  const OrderedJson copy = json;
  EXPECT_EQ(copy, json);
  EXPECT_EQ(copy.dump(), json.dump());
}

/// It keeps the last value at the first position.
TEST(OrderedJson, HoldsAKeyOnce) {
  EXPECT_EQ(OrderedJson::parse(R"({"z":1,"a":2,"z":3})").dump(), R"({"z":3,"a":2})");
}

TEST(OrderedJson, FindsAndRemovesKeys) {
  OrderedJson json = {{"z", 1}, {"a", 2}, {"m", 3}};
  EXPECT_EQ(json.at("a"), 2);
  EXPECT_EQ(json.value("b", 7), 7);
  EXPECT_THROW(json.at("b"), OrderedJson::exception);
  EXPECT_TRUE(json.contains("m"));
  EXPECT_EQ(json.erase("a"), 1U);
  EXPECT_EQ(json.erase("a"), 0U);
  EXPECT_FALSE(json.contains("a"));
  EXPECT_EQ(json.dump(), R"({"z":1,"m":3})");
}

TEST(OrderedJson, TakesOtherMaps) {
  const std::map<std::string, int> map = {{"a", 1}, {"b", 2}};
  const OrderedJson json = map;
  EXPECT_EQ(json.dump(), R"({"a":1,"b":2})");
  EXPECT_EQ((json.get<std::map<std::string, int>>()), map);
}

}  // namespace
}  // namespace cbmv
