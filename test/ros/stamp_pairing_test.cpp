#include "ros/stamp_pairing.h"

#include <vector>

#include <boost/make_shared.hpp>
#include <gtest/gtest.h>
#include <sensor_msgs/Image.h>

namespace cbmv {
namespace {

using sensor_msgs::Image;
using Stamps = std::vector<double>;

constexpr double kDelayS = 0.02;  // delay of the right camera if stamps need not be equal

boost::shared_ptr<const Image> at(double stamp_s) {
  auto message = boost::make_shared<Image>();
  message->header.stamp.fromSec(stamp_s);
  return message;
}

class Pairing : public testing::Test {
 protected:
  explicit Pairing(const SyncOptions& options = {5, false, 0.1})
      : pairing_(options, [this](const auto& left, const auto& right) {
          paired_.push_back(left->header.stamp.toSec());
          partners_.push_back(right->header.stamp.toSec());
        }) {}

  void addLeft(double stamp_s) { pairing_.add<0>(at(stamp_s)); }
  void addRight(double stamp_s) { pairing_.add<1>(at(stamp_s)); }

  Stamps paired_;    ///< stamps of the left messages
  Stamps partners_;  ///< stamps of the right messages
  StampPairing<Image, Image> pairing_;
};

/// With equal stamps, and with a right camera that is late by kDelayS.
class Streams : public Pairing, public testing::WithParamInterface<bool> {
 protected:
  Streams() : Pairing({5, GetParam(), 0.1}) {}

  double delayS() const { return GetParam() ? kDelayS : 0; }
  /// Adds frames at 10 Hz; returns their stamps.
  Stamps addFrames(double start_s, int count, bool left = true, bool right = true) {
    Stamps stamps;
    for (int i = 0; i < count; ++i) {
      const double stamp_s = start_s + 0.1 * i;
      stamps.push_back(at(stamp_s)->header.stamp.toSec());
      if (left) {
        addLeft(stamp_s);
      }
      if (right) {
        addRight(stamp_s + delayS());
      }
    }
    return stamps;
  }
  /// Expects all of `frames` once and in order. With different stamps, the last one may still wait
  /// for the next message.
  void expectPairs(const Stamps& frames) {
    Stamps wanted = frames;
    if (GetParam()) {
      wanted.pop_back();
    }
    EXPECT_EQ(paired_, wanted);
    for (std::size_t i = 0; i < partners_.size(); ++i) {
      EXPECT_NEAR(partners_[i], paired_[i] + delayS(), 1e-6);
    }
    paired_.clear();
    partners_.clear();
  }
};

TEST_P(Streams, AllPairsComeInOrderAndOnce) { expectPairs(addFrames(1000, 20)); }

TEST_P(Streams, AfterOneCameraWasSilent) {
  addFrames(1000, 600, true, false);
  EXPECT_EQ(paired_, Stamps{});
  expectPairs(addFrames(1060, 10));
}

TEST_P(Streams, AnEarlierTimeAfterOneCameraWasSilent) {
  addFrames(1000, 600, true, false);
  expectPairs(addFrames(10, 10));
}

TEST_P(Streams, AnEarlierTimeAfterOneCameraWasSilentAndInputsWereClosed) {
  addFrames(1000, 20, false, true);
  pairing_.clear();
  expectPairs(addFrames(10, 10));
}

TEST_P(Streams, RecordingsThatLoop) {
  for (int loop = 0; loop < 3; ++loop) {
    const Stamps frames = addFrames(1000, 10);
    addFrames(1001, 7, true, false);  // interrupted: no message of the right camera
    // The next message has arrived, which makes the last pair certain.
    EXPECT_EQ(paired_, frames);
    paired_.clear();
    partners_.clear();
  }
}

TEST_P(Streams, LeapsOfBothCameras) {
  for (const double start_s : {1000.0, 5e6, 20.0, 4e9, 19.0}) {
    SCOPED_TRACE(start_s);
    const Stamps frames = addFrames(start_s, 8);
    if (!paired_.empty() && paired_.front() != frames.front()) {  // became certain by the jump
      paired_.erase(paired_.begin());
      partners_.erase(partners_.begin());
    }
    expectPairs(frames);
  }
}

TEST_P(Streams, OneCameraLeapsAheadForAWhile) {
  for (int i = 0; i < 8; ++i) {
    addLeft(5000 + 0.1 * i);
    addRight(1000 + 0.1 * i);
  }
  EXPECT_EQ(paired_, Stamps{});
  expectPairs(addFrames(1000.8, 8));
}

TEST_P(Streams, OneCameraFallsBackForAWhile) {
  for (int i = 0; i < 8; ++i) {
    addLeft(0);  // unset stamps
    addRight(1000 + 0.1 * i);
  }
  expectPairs(addFrames(1000.8, 8));
}

/// The queue is full of messages with a later time that does not yet count as another time.
TEST_P(Streams, ASmallStepBackHoldsNothingUp) {
  for (int i = 0; i < 5; ++i) {
    addLeft(1000.25 + 0.05 * i);
  }
  const Stamps frames = addFrames(1000, 8);
  if (GetParam()) {
    EXPECT_GE(paired_.size(), frames.size() - 2);  // some of them with the waiting ones
    EXPECT_EQ(paired_.back(), frames[frames.size() - 2]);
  } else {
    EXPECT_EQ(paired_, frames);
  }
}

TEST_P(Streams, WhatIsClearedIsNotPaired) {
  addLeft(1);
  pairing_.clear();
  addRight(1);
  EXPECT_EQ(paired_, Stamps{});
  addLeft(1);
  EXPECT_EQ(paired_, Stamps{1});
}

INSTANTIATE_TEST_SUITE_P(Stamps, Streams, testing::Bool(),
                         [](const auto& parameter) { return parameter.param ? "Close" : "Equal"; });

TEST_F(Pairing, CloseStampsAreNotEqual) {
  addLeft(1);
  addRight(1.000001);
  addLeft(2);
  addRight(2.000001);
  EXPECT_EQ(paired_, Stamps{});
}

TEST_F(Pairing, SmallStepsBackCostNoPair) {
  for (const double stamp_s : {10.3, 10.2, 10.4, 10.1}) {
    addLeft(stamp_s);
    addRight(stamp_s);
  }
  EXPECT_EQ(paired_, (Stamps{10.3, 10.2, 10.4, 10.1}));
}

TEST_F(Pairing, MessagesOfOneTopicMayBeOutOfOrder) {
  addLeft(2);
  addLeft(1.9);
  addRight(1.9);
  addRight(2);
  EXPECT_EQ(paired_, (Stamps{1.9, 2}));
}

TEST_F(Pairing, PairsDoNotGoBack) {
  addLeft(1.9);
  addLeft(2);
  addRight(2);
  addRight(1.9);
  EXPECT_EQ(paired_, (Stamps{2}));
}

TEST_F(Pairing, SoManyMayWait) {
  for (int i = 0; i < 6; ++i) {
    addLeft(1 + 0.1 * i);
  }
  addRight(1);
  EXPECT_EQ(paired_, Stamps{});
  addRight(1.1);
  EXPECT_EQ(paired_, Stamps{1.1});
}

TEST_F(Pairing, OneMayWaitForItsPartner) {
  StampPairing<Image, Image> pairing({1, true, 0.1}, [this](const auto& left, const auto&) {
    paired_.push_back(left->header.stamp.toSec());
  });
  for (const double stamp_s : {1.0, 1.1, 1.2}) {
    pairing.add<0>(at(stamp_s));
    pairing.add<1>(at(stamp_s + kDelayS));
  }
  EXPECT_EQ(paired_, (Stamps{1, 1.1}));
}

/// A simulation that is reset: waiting messages do not belong to new ones, even if the stamps are
/// equal.
TEST_F(Pairing, WhatWaitsOfATimeBeforeAJumpIsDropped) {
  addLeft(10);
  addRight(9.9);
  addRight(2);
  addRight(10);
  EXPECT_EQ(paired_, Stamps{});
}

TEST_F(Pairing, StampsThatComeTwice) {
  for (int i = 0; i < 3; ++i) {
    addLeft(0);
    addRight(0);
  }
  EXPECT_EQ(paired_, (Stamps{0, 0, 0}));
  addLeft(7);
  addLeft(7);
  addRight(7);
  addRight(7);  // its partner was dropped with the pair
  EXPECT_EQ(paired_, (Stamps{0, 0, 0, 7}));
}

class ClosePairing : public Pairing {
 protected:
  ClosePairing() : Pairing({5, true, 0.1}) {}
};

TEST_F(ClosePairing, EqualStampsNeedNotWait) {
  addLeft(1);
  addRight(1);
  EXPECT_EQ(paired_, Stamps{1});
}

TEST_F(ClosePairing, ThePartnerIsTheNearest) {
  addLeft(1);
  addRight(1.09);  // nearer to the next one
  addLeft(1.1);
  EXPECT_EQ(paired_, Stamps{});
  addRight(1.19);
  EXPECT_EQ(paired_, Stamps{1.1});
  EXPECT_EQ(partners_, Stamps{1.09});
}

TEST_F(ClosePairing, FartherThanTheBoundIsNoPair) {
  for (int i = 0; i < 4; ++i) {
    addLeft(1 + i);
    addRight(1.11 + i);
  }
  EXPECT_EQ(paired_, Stamps{});
}

TEST_F(ClosePairing, WithoutABoundAnyDistanceWillDo) {
  StampPairing<Image, Image> pairing({5, true, 0}, [this](const auto& left, const auto&) {
    paired_.push_back(left->header.stamp.toSec());
  });
  for (const double stamp_s : {0.0, 1e9, 2e9}) {
    pairing.add<0>(at(stamp_s));
    pairing.add<1>(at(stamp_s + 4e8));
  }
  EXPECT_EQ(paired_, (Stamps{0, 1e9}));
}

}  // namespace
}  // namespace cbmv
