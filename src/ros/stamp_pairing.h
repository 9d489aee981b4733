#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <tuple>
#include <utility>

#include <boost/bind/bind.hpp>
#include <boost/shared_ptr.hpp>
#include <message_filters/sync_policies/approximate_time.h>
#include <message_filters/sync_policies/exact_time.h>
#include <message_filters/synchronizer.h>
#include <ros/time.h>

namespace cbmv {

/// How messages of several topics are paired.
struct SyncOptions {
  int queue_size = 5;
  bool approximate = false;
  double max_interval_s = 0;  ///< 0: no bound
};

/// Sets of messages of four topics, with equal or close stamps, by message_filters' policies. These
/// let messages with old stamps go first: one that waits with a stamp of a time to come would keep
/// others from being paired until then. So whoever sees that time has jumped back says so.
/// Not for several threads at a time.
template <typename M0, typename M1, typename M2, typename M3>
class StampPairing {
 public:
  template <typename Message>
  using Pointer = boost::shared_ptr<const Message>;
  using Callback = std::function<void(const Pointer<M0>&, const Pointer<M1>&, const Pointer<M2>&,
                                      const Pointer<M3>&)>;

  StampPairing(const SyncOptions& options, Callback callback)
      : options_(options), callback_(std::move(callback)) {
    clear();
  }

  /// Calls back with the set that the message completes. May throw, and has to be cleared then:
  /// message_filters compute differences of stamps, which ros::Duration does not hold beyond 68
  /// years.
  template <std::size_t kTopic>
  void add(const Pointer<std::tuple_element_t<kTopic, std::tuple<M0, M1, M2, M3>>>& message) {
    auto& waiting = std::get<kTopic>(waiting_);
    waiting.push_back(message);
    if (waiting.size() > static_cast<std::size_t>(options_.queue_size)) {
      waiting.pop_front();
    }
    if (exact_) {
      exact_->template add<kTopic>(message);
    } else {
      approximate_->template add<kTopic>(message);
    }
  }

  /// Drops all that waits.
  void clear() {
    waiting_ = {};
    const auto queue = static_cast<std::uint32_t>(options_.queue_size);
    if (!options_.approximate) {
      exact_ = makeSynchronizer(ExactPolicy(queue));
      return;
    }
    ApproximatePolicy policy(queue);
    if (options_.max_interval_s > 0) {
      policy.setMaxIntervalDuration(ros::Duration(options_.max_interval_s));
    }
    approximate_ = makeSynchronizer(policy);
  }

  /// Drops what waits with later stamps. Throws as add does.
  void dropAfter(const ros::Time& stamp) {
    const Waiting before = waiting_;
    clear();
    addUpTo<0>(before, stamp);
    addUpTo<1>(before, stamp);
    addUpTo<2>(before, stamp);
    addUpTo<3>(before, stamp);
  }

 private:
  using ExactPolicy = message_filters::sync_policies::ExactTime<M0, M1, M2, M3>;
  using ApproximatePolicy = message_filters::sync_policies::ApproximateTime<M0, M1, M2, M3>;
  using Waiting = std::tuple<std::deque<Pointer<M0>>, std::deque<Pointer<M1>>,
                             std::deque<Pointer<M2>>, std::deque<Pointer<M3>>>;

  template <typename Policy>
  std::unique_ptr<message_filters::Synchronizer<Policy>> makeSynchronizer(const Policy& policy) {
    auto synchronizer = std::make_unique<message_filters::Synchronizer<Policy>>(policy);
    synchronizer->registerCallback(boost::bind(&StampPairing::receive, this,
                                               boost::placeholders::_1, boost::placeholders::_2,
                                               boost::placeholders::_3, boost::placeholders::_4));
    return synchronizer;
  }

  template <std::size_t kTopic>
  void addUpTo(const Waiting& messages, const ros::Time& stamp) {
    for (const auto& message : std::get<kTopic>(messages)) {
      if (message->header.stamp <= stamp) {
        add<kTopic>(message);
      }
    }
  }

  void receive(const Pointer<M0>& first, const Pointer<M1>& second, const Pointer<M2>& third,
               const Pointer<M3>& fourth) {
    forgetUpTo<0>(first);
    forgetUpTo<1>(second);
    forgetUpTo<2>(third);
    forgetUpTo<3>(fourth);
    callback_(first, second, third, fourth);
  }

  template <std::size_t kTopic, typename Message>
  void forgetUpTo(const Message& message) {
    auto& waiting = std::get<kTopic>(waiting_);
    const auto found = std::find(waiting.begin(), waiting.end(), message);
    if (found != waiting.end()) {
      waiting.erase(waiting.begin(), found + 1);
    }
  }

  const SyncOptions options_;
  const Callback callback_;
  Waiting waiting_;  ///< what the synchronizer may hold
  std::unique_ptr<message_filters::Synchronizer<ExactPolicy>> exact_;  ///< one of both is there
  std::unique_ptr<message_filters::Synchronizer<ApproximatePolicy>> approximate_;
};

}  // namespace cbmv
