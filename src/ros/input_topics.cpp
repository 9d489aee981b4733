#include "ros/input_topics.h"

#include "ros/nodelet_inputs.h"

#include "cbmv_stereo/error.h"

namespace cbmv {

std::string inputName(const ros::NodeHandle& nh, const std::string& name,
                      const std::string& configured) {
  const bool is_remapped = nh.resolveName(name, true) != nh.resolveName(name, false);
  return is_remapped ? name : configured;
}

TopicNames stereoInputNames(const ros::NodeHandle& nh, const PrivateParameters& parameters) {
  TopicNames names;
  for (std::size_t i = 0; i < kInputs; ++i) {
    names[i] = inputName(nh, kStereoInputTopics[i],
                         parameters.get<std::string>(kStereoTopicParameters[i]));
  }
  return names;
}

std::string colorInputName(const ros::NodeHandle& nh, const PrivateParameters& parameters) {
  return inputName(nh, kColorTopic, parameters.get<std::string>(kColorTopicParameter));
}

void requireDifferentTopics(const TopicNames& names) {
  for (std::size_t i = 0; i < kInputs; ++i) {
    for (std::size_t j = i + 1; j < kInputs; ++j) {
      if (names[i] == names[j]) {
        throw Error("two inputs have the same topic " + names[i] +
                    ", expected different topics. Check the remaps and the topic arguments of the "
                    "launch file");
      }
    }
  }
}

std::string nameToSubscribe(const ros::NodeHandle& nh, const std::string& name) {
  const std::string resolved = nh.resolveName(name);
  return nh.resolveName(resolved) == resolved ? resolved : name;
}

}  // namespace cbmv
