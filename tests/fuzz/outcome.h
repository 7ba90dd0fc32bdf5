#pragma once
#include <string>
#include <vector>

#include "fuzz/child.h"
#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

enum class Outcome {
    Rendered,   ///< exit 0, a picture of finite values, no warning
    Warned,     ///< the same with warnings
    Refused,    ///< exit 1, no picture, every error names its place or file
    Stopped,    ///< too slow; ended when asked to
    Signal,     ///< a crash
    Sanitizer,  ///< a report of AddressSanitizer or UndefinedBehaviorSanitizer
    Hang,       ///< too slow, and deaf to SIGTERM
    Memory,     ///< memory ran out and nobody said what wanted it
    Message,    ///< an error without a place, or in the words of a library; far too many words
    Silent,     ///< an error without a message, or success without a picture
    Picture,    ///< values that are not finite, or a picture in spite of an error
};
constexpr int kOutcomeCount = 11;

const char *Name(Outcome outcome);
inline bool IsFailure(Outcome outcome) { return outcome >= Outcome::Signal; }

struct Verdict {
    Outcome outcome = Outcome::Rendered;
    std::string cause;  ///< equal for failures that have the same reason; empty if it is no failure
};

/// Judges a run. `left` are the names of the files that the run left in its folder beside those of the case.
Verdict Judge(const ChildResult &result, const FuzzCase &fuzzCase, const std::vector<std::string> &left);

/// Function names of this process's code at `frames`, innermost first; "" for what is not ours.
std::vector<std::string> OurFunctions(const std::vector<void *> &frames);

}  // namespace pbrt::fuzz
