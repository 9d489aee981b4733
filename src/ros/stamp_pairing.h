#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include <boost/shared_ptr.hpp>
#include <ros/time.h>

#include "ros/stamps.h"

namespace cbmv {

/// How messages of two topics are paired.
struct SyncOptions {
  int queue_size = 5;
  bool approximate = false;
  double max_interval_s = 0;  ///< with approximate; 0: no limit
};

/// Pairs messages of two topics by the same rule as bag files (pairStamps): each message is nearest
/// in time to the other, and the stamps are equal or, with `approximate`, at most max_interval_s
/// apart. A pair is passed on as soon as it is certain: immediately if the stamps are equal, else
/// when the topic with the earlier stamp has its next message.
///
/// A message never blocks others, whatever its stamp. A full queue drops the message that arrived
/// first. A pair also drops all waiting messages with older stamps. So pairs never go back in time
/// unless the stamps of both topics do.
///
/// The policies of message_filters are not sufficient: ExactTime drops the smallest stamps first,
/// so messages with a future stamp block all others. Not thread-safe.
template <typename First, typename Second>
class StampPairing {
 public:
  template <typename Message>
  using Pointer = boost::shared_ptr<const Message>;
  using Callback = std::function<void(const Pointer<First>&, const Pointer<Second>&)>;

  /// A larger step back in the stamps of a topic starts a new time: a looping bag. A smaller one is
  /// a message out of order.
  static constexpr double kJumpS = 0.5;

  StampPairing(const SyncOptions& options, Callback callback)
      : queue_size_(static_cast<std::size_t>(options.queue_size)),
        largest_distance_ns_(largestDistanceNs(options)),
        callback_(std::move(callback)) {}

  /// Calls back with each pair that this message makes certain.
  template <std::size_t kTopic>
  void add(const Pointer<std::tuple_element_t<kTopic, std::tuple<First, Second>>>& message) {
    const ros::Time& stamp = message->header.stamp;
    const auto before = std::exchange(newest_stamps_[kTopic], stamp);
    if (before && secondsBetween(stamp, *before) > kJumpS) {
      dropAfter(stamp);
    }
    auto& waiting = std::get<kTopic>(waiting_);
    waiting.push_back(message);
    while (takePair()) {
    }
    if (waiting.size() > queue_size_) {
      waiting.pop_front();
    }
  }

  /// Drops all waiting messages.
  void clear() {
    waiting_ = {};
    newest_stamps_ = {};
  }

 private:
  template <typename Message>
  using Queue = std::deque<Pointer<Message>>;  ///< in order of arrival

  static std::int64_t largestDistanceNs(const SyncOptions& options) {
    if (!options.approximate) {
      return 0;
    }
    return options.max_interval_s > 0 ? std::llround(options.max_interval_s * 1e9)
                                      : std::numeric_limits<std::int64_t>::max();
  }

  template <typename Message>
  static std::int64_t distanceNs(const Pointer<Message>& message, const ros::Time& stamp) {
    return std::abs(nanosecondsBetween(message->header.stamp, stamp));
  }

  /// At equal distance, prefers the earlier stamp; with equal stamps, the message that arrived
  /// last.
  template <typename Message>
  static const Pointer<Message>& nearest(const Queue<Message>& waiting, const ros::Time& stamp) {
    return *std::min_element(waiting.rbegin(), waiting.rend(), [&](const auto& a, const auto& b) {
      return std::pair(distanceNs(a, stamp), a->header.stamp) <
             std::pair(distanceNs(b, stamp), b->header.stamp);
    });
  }

  /// Whether the next message of the topic has arrived.
  template <typename Message>
  static bool isFollowed(const Queue<Message>& waiting, const Pointer<Message>& message) {
    return std::any_of(waiting.begin(), waiting.end(), [&](const auto& other) {
      return other != message && other->header.stamp >= message->header.stamp;
    });
  }

  bool isCertain(const Pointer<First>& first, const Pointer<Second>& second) const {
    const auto& [firsts, seconds] = waiting_;
    const ros::Time& a = first->header.stamp;
    const ros::Time& b = second->header.stamp;
    return a == b || (a < b ? isFollowed(firsts, first) : isFollowed(seconds, second));
  }

  /// Calls back with a pair, if one is certain.
  bool takePair() {
    auto& [firsts, seconds] = waiting_;
    if (seconds.empty()) {
      return false;
    }
    for (const auto& candidate : firsts) {
      const auto& partner = nearest(seconds, candidate->header.stamp);
      if (distanceNs(partner, candidate->header.stamp) <= largest_distance_ns_ &&
          nearest(firsts, partner->header.stamp) == candidate && isCertain(candidate, partner)) {
        const Pointer<First> first = candidate;
        const Pointer<Second> second = partner;
        dropUpTo(first->header.stamp, firsts);
        dropUpTo(second->header.stamp, seconds);
        callback_(first, second);
        return true;
      }
    }
    return false;
  }

  template <typename Message, typename Condition>
  static void dropIf(Queue<Message>& waiting, const Condition& condition) {
    waiting.erase(
        std::remove_if(waiting.begin(), waiting.end(),
                       [&](const auto& message) { return condition(message->header.stamp); }),
        waiting.end());
  }

  template <typename Message>
  static void dropUpTo(const ros::Time& stamp, Queue<Message>& waiting) {
    dropIf(waiting, [&](const ros::Time& waits) { return waits <= stamp; });
  }

  /// Drops messages from a later time than `stamp`.
  void dropAfter(const ros::Time& stamp) {
    const auto is_later = [&](const ros::Time& waits) {
      return secondsBetween(stamp, waits) > kJumpS;
    };
    dropIf(std::get<0>(waiting_), is_later);
    dropIf(std::get<1>(waiting_), is_later);
  }

  const std::size_t queue_size_;
  const std::int64_t largest_distance_ns_;
  const Callback callback_;
  std::tuple<Queue<First>, Queue<Second>> waiting_;
  std::array<std::optional<ros::Time>, 2> newest_stamps_;  ///< stamp of each topic's last message
};

}  // namespace cbmv
