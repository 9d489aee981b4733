#pragma once

#include <array>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

namespace cbmv {

/// JSON that is larger or deeper than any valid file. The text is the predicate of the error
/// message.
struct JsonTooLarge : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Counts the events of the parser. Deep nesting would overflow the stack of code that traverses
/// the JSON. An object with n keys takes time in n². A value takes up to 40 times the memory of its
/// text.
class JsonBounds {
 public:
  static constexpr int kMaxDepth = 64;
  static constexpr int kMaxKeys = 4096;        ///< per object
  static constexpr long kMaxValues = 8000000;  ///< including keys and brackets

  /// Counts one event of the parser inside of `depth` brackets. Throws JsonTooLarge.
  void count(int depth, nlohmann::json::parse_event_t event) {
    using Event = nlohmann::json::parse_event_t;
    require(++values_ <= kMaxValues, "has more than ", kMaxValues, " values");
    const bool opens = event == Event::object_start || event == Event::array_start;
    require(!opens || depth < kMaxDepth, "has more than ", kMaxDepth, " nesting levels");
    if (opens) {
      keys_[depth + 1] = 0;
    } else if (event == Event::key) {
      require(++keys_[depth] <= kMaxKeys, "has an object with more than ", kMaxKeys, " keys");
    }
  }

 private:
  /// Builds the message only on error, because it is called for every value.
  static void require(bool good, const char* begin, long bound, const char* end) {
    if (!good) {
      throw JsonTooLarge(begin + std::to_string(bound) + end);
    }
  }

  std::array<int, kMaxDepth + 1> keys_{};  ///< keys so far of the object at each depth
  long values_ = 0;
};

/// Parses JSON within these limits. Throws JsonTooLarge or Json::parse_error.
template <typename Json>
Json parseBounded(const std::string& text) {
  JsonBounds bounds;
  return Json::parse(text, [&bounds](int depth, typename Json::parse_event_t event, Json&) {
    bounds.count(depth, static_cast<nlohmann::json::parse_event_t>(event));
    return true;
  });
}

}  // namespace cbmv
