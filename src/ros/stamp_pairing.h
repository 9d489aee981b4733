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
  double max_interval_s = 0;  ///< with approximate; 0: no bound
};

/// Pairs of messages of two topics, by the rule that recordings are paired by (pairStamps): each is
/// the nearest in time to the other, and their stamps are equal or, with `approximate`, not farther
/// apart than max_interval_s. A pair comes as soon as it is certain: at once if the stamps are
/// equal, else when the topic with the earlier stamp has its next message.
///
/// No message ever blocks others, whatever its stamp: partners are looked up, and the oldest in
/// order of arrival makes room. What waits with older stamps than those of a pair is dropped with
/// it, so pairs do not go back in time but where the stamps of both topics do.
///
/// message_filters' policies do not do: ExactTime gives up the smallest stamps first, so messages
/// of a time to come keep all others from being paired. Not for several threads at a time.
template <typename First, typename Second>
class StampPairing {
 public:
  template <typename Message>
  using Pointer = boost::shared_ptr<const Message>;
  using Callback = std::function<void(const Pointer<First>&, const Pointer<Second>&)>;

  /// Stamps that go back on a topic by more begin another time: a recording that loops. By less,
  /// messages are out of order.
  static constexpr double kJumpS = 0.5;

  StampPairing(const SyncOptions& options, Callback callback)
      : queue_size_(static_cast<std::size_t>(options.queue_size)),
        largest_distance_ns_(largestDistanceNs(options)),
        callback_(std::move(callback)) {}

  /// Calls back with each pair that the message makes certain.
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

  /// Drops all that waits.
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

  /// Of messages as near: the one with the earlier stamp; of equal stamps: the one that came last.
  template <typename Message>
  static const Pointer<Message>& nearest(const Queue<Message>& waiting, const ros::Time& stamp) {
    return *std::min_element(waiting.rbegin(), waiting.rend(), [&](const auto& a, const auto& b) {
      return std::pair(distanceNs(a, stamp), a->header.stamp) <
             std::pair(distanceNs(b, stamp), b->header.stamp);
    });
  }

  /// Whether the next message of the topic is there, too.
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

  /// Drops what is of a later time than messages with `stamp`.
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
  std::array<std::optional<ros::Time>, 2> newest_stamps_;  ///< of each topic's last message
};

}  // namespace cbmv
