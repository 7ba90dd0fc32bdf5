#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fuzz/child.h"
#include "fuzz/fuzz_case.h"

namespace pbrt::fuzz {

enum class Outcome {
    Rendered,   ///< exit 0, a picture of finite values, no warning
    Warned,     ///< the same with warnings
    Refused,    ///< exit 1, no picture, every error names its place or file
    Stopped,    ///< too slow; ended by its stop request
    Signal,     ///< a crash
    Sanitizer,  ///< a report of AddressSanitizer or UndefinedBehaviorSanitizer
    Hang,       ///< too slow, and did not end after SIGTERM
    Memory,     ///< memory ran out, and no message names what needed it
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

/// The failures with the same cause.
struct Cause {
    Outcome outcome = Outcome::Signal;
    uint64_t count = 0, firstNumber = 0;
    std::string folder;  ///< where the shrunk case is
};

/// What a run of cases found.
struct Tally {
    uint64_t seed = 0, from = 0, cases = 0;
    double seconds = 0;
    std::string version;
    std::map<std::string, std::array<uint64_t, kOutcomeCount>> counts;  ///< by kind of mutation
    std::map<std::string, Cause> causes;

    void Add(uint64_t number, const FuzzCase &fuzzCase, const Verdict &verdict);
    uint64_t Failures() const;
};

/// Kinds of mutations as rows, outcomes as columns; then the causes of failures.
std::string Markdown(const Tally &tally);

/// Writes the case's files, its messages and case.json, which ReadCase reads.
void SaveCase(const std::string &folder, const FuzzCase &fuzzCase, const Verdict &verdict, const std::string &messages);
FuzzCase ReadCase(const std::string &caseJson);

}  // namespace pbrt::fuzz
