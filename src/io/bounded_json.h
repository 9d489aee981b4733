#pragma once

#include <array>
#include <stdexcept>
#include <string>

#include <nlohmann/json.hpp>

namespace cbmv {

/// JSON that is larger or deeper than any file of ours; the text is what to say of the file.
struct JsonTooLarge : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Counts what the parser finds. Deep nesting would overflow the stack of what walks over it, an
/// object with many keys takes time with the square of their number, and a value takes up to forty
/// times the memory of its text.
class JsonBounds {
 public:
  static constexpr int kMaxDepth = 64;
  static constexpr int kMaxKeys = 4096;        ///< of an object
  static constexpr long kMaxValues = 8000000;  ///< keys and brackets count, too

  /// A step of the parser, inside of `depth` brackets. Throws JsonTooLarge.
  void count(int depth, nlohmann::json::parse_event_t event) {
    using Event = nlohmann::json::parse_event_t;
    require(++values_ <= kMaxValues, "holds more than ", kMaxValues, " values");
    const bool opens = event == Event::object_start || event == Event::array_start;
    require(!opens || depth < kMaxDepth, "has brackets in more than ", kMaxDepth, " levels");
    if (opens) {
      keys_[depth + 1] = 0;
    } else if (event == Event::key) {
      require(++keys_[depth] <= kMaxKeys, "has an object of more than ", kMaxKeys, " keys");
    }
  }

 private:
  /// No text is made where all is good: this is called for every value.
  static void require(bool good, const char* begin, long bound, const char* end) {
    if (!good) {
      throw JsonTooLarge(begin + std::to_string(bound) + end);
    }
  }

  std::array<int, kMaxDepth + 1> keys_{};  ///< so far, of the object at each depth
  long values_ = 0;
};

/// Throws JsonTooLarge, or Json::parse_error.
template <typename Json>
Json parseBounded(const std::string& text) {
  JsonBounds bounds;
  return Json::parse(text, [&bounds](int depth, typename Json::parse_event_t event, Json&) {
    bounds.count(depth, static_cast<nlohmann::json::parse_event_t>(event));
    return true;
  });
}

}  // namespace cbmv
