#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pbrt/core/error.h"

namespace pbrt::test {

/// The first error that `act` throws; a default one if it throws nothing.
template <class Act>
Diagnostic ErrorOf(const Act &act) {
    try {
        act();
    } catch (const UserError &e) {
        return e.Diagnostics().front();
    }
    return {};
}

/// The only error that `act` throws.
template <class Act>
Diagnostic OnlyErrorOf(const Act &act) {
    try {
        act();
    } catch (const UserError &e) {
        EXPECT_EQ(e.Diagnostics().size(), 1u) << FormatAll(e);
        return e.Diagnostics().front();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

/// The message of the first error; empty if `act` throws nothing.
template <class Act>
std::string MessageOf(const Act &act) {
    return ErrorOf(act).message;
}

/// Expects that all words are in the text.
inline void ExpectWords(const std::string &text, const std::vector<std::string> &words) {
    for (const std::string &word : words) EXPECT_NE(text.find(word), std::string::npos) << word << ": " << text;
}

/// Expects that `act` throws an error whose message has all words: names, values or valid choices.
template <class Act>
void ExpectError(const Act &act, const std::vector<std::string> &words) {
    const std::string message = MessageOf(act);
    EXPECT_NE(message, "") << "nothing was thrown";
    ExpectWords(message, words);
}

/// The same of the only error, at this line of the input.
template <class Act>
void ExpectErrorAt(const Act &act, int line, const std::vector<std::string> &words) {
    const Diagnostic error = OnlyErrorOf(act);
    EXPECT_EQ(error.loc.line, line) << error.message;
    ExpectWords(error.message, words);
}

}  // namespace pbrt::test
