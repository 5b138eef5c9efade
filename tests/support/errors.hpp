// Expecting claray::Error of a kind, with words in its message.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "claray/error.hpp"

namespace claray::test {

/// Passes if `function` throws claray::Error of this kind with a message that contains `words`.
template <class Function>
testing::AssertionResult throws_error(ErrorKind kind, const std::string& words, Function&& function) {
    try {
        function();
    } catch (const Error& error) {
        const std::string message = error.what();
        if (error.kind() != kind)
            return testing::AssertionFailure()
                   << "kind " << int(error.kind()) << " instead of " << int(kind) << ": " << message;
        if (message.find(words) == std::string::npos)
            return testing::AssertionFailure() << "no '" << words << "' in: " << message;
        return testing::AssertionSuccess() << message;
    }
    return testing::AssertionFailure() << "nothing was thrown";
}

}  // namespace claray::test
