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
    Hang,       ///< too slow, and did not end after SIGTERM
    Memory,     ///< memory ran out, and no message says what needed it
    Message,    ///< an error without a place, in the words of a library, or of more than a megabyte
    Silent,     ///< an error without a message, or success without a picture
    Picture,    ///< values that are not finite, or a picture in spite of an error
    Accepted,   ///< a render from a file that must be refused (FuzzCase::mustBeRefused)
};
constexpr int kOutcomeCount = 12;

const char *Name(Outcome outcome);
inline bool IsFailure(Outcome outcome) { return outcome >= Outcome::Signal; }

struct Verdict {
    Outcome outcome = Outcome::Rendered;
    std::string cause;  ///< equal for failures with the same reason; empty if the run did not fail
};

/// True if lightlab warned of a stored reference that it does not use.
bool RendersReferenceAgain(const ChildResult &result);

/// Judges a run. `left` are the names of the files that the run left in its folder beside those of the case.
Verdict Judge(const ChildResult &result, const FuzzCase &fuzzCase, const std::vector<std::string> &left);

/// Function names of this process's code at `frames`, innermost first; "" for frames outside this process's code.
std::vector<std::string> OurFunctions(const std::vector<void *> &frames);

}  // namespace pbrt::fuzz
