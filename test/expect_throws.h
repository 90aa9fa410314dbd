#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

namespace saw_ndt {

/// Expects `work()` to throw an Exception whose message holds every one of `parts`.
template <typename Exception, typename Work>
void expectThrows(Work work, std::initializer_list<std::string> parts) {
  try {
    work();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Exception& error) {
    for (const std::string& part : parts)
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << "'" << error.what() << "' lacks '" << part << "'";
  }
}

}  // namespace saw_ndt
