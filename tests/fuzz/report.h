#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fuzz/fuzz_case.h"
#include "fuzz/outcome.h"

namespace pbrt::fuzz {

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
