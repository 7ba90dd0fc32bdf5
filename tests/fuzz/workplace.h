#pragma once
#include <functional>
#include <optional>
#include <string>

#include "fuzz/child.h"
#include "fuzz/fuzz_case.h"
#include "fuzz/outcome.h"

namespace pbrt::fuzz {

/// Loads and sets up everything that each run of pbrt needs, without threads, so that forked children have it. Writes
/// and removes files in the current folder, which must be the working folder of a child.
void PrepareProgram(const std::string &folder);

/// The folder of lightlab's experiment and references, below the working folder. A case with a reference removes it.
constexpr const char *kLabFolder = "lab";

/// Runs pbrt or lightlab on the case's files, which lie in the working folder, and checks the image. For a child.
int RunProgram(const FuzzCase &fuzzCase, PictureReport &report);

/// Reports on the image that the program wrote.
void CheckImage(const std::string &path, PictureReport &report);

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
    /// The result, when the case has ended; waits for it at most so long.
    std::optional<CaseResult> Poll(int milliseconds = 0);
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
