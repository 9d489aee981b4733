#pragma once

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

#include "cbmv_stereo/error.h"

namespace cbmv {

/// The message of the Error thrown by `call`; "no error" if it throws none.
template <typename Call>
std::string errorText(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// Whether `text` contains all of `parts`: EXPECT_TRUE(mentions(text, {"left.png", "4x3"})).
inline testing::AssertionResult mentions(const std::string& text,
                                         std::initializer_list<std::string> parts) {
  for (const std::string& part : parts) {
    if (text.find(part) == std::string::npos) {
      return testing::AssertionFailure() << '"' << text << "\" does not mention \"" << part << '"';
    }
  }
  return testing::AssertionSuccess();
}

}  // namespace cbmv
