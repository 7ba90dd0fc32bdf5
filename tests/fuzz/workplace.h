#pragma once
#include <functional>
#include <optional>
#include <string>

#include "fuzz/child.h"
#include "fuzz/fuzz_case.h"
#include "fuzz/outcome.h"
#include "fuzz/program.h"

namespace pbrt::fuzz {

struct CaseResult {
    Verdict verdict;
    ChildResult run;
};

/// A folder in which one case at a time runs.
class Workplace {
  public:
    /// The function that runs in the child: RunProgram, or in tests one that fails in a known way.
    using Program = std::function<int(const FuzzCase &, PictureReport &)>;
    /// Deletes the contents of the folder.
    explicit Workplace(std::string folder, Program program = RunProgram);

    void Start(const FuzzCase &fuzzCase, const Limits &limits);
    bool Running() const { return child_.Running(); }
    int EndDescriptor() const { return child_.EndDescriptor(); }
    /// The result, when the case has ended.
    std::optional<CaseResult> Poll();
    /// Start and Poll until the end.
    CaseResult Run(const FuzzCase &fuzzCase, const Limits &limits);

  private:
    std::string folder_;
    Program program_;
    FuzzCase case_;
    Child child_;
};

void WriteFiles(const FuzzCase &fuzzCase, const std::string &folder);

}  // namespace pbrt::fuzz
