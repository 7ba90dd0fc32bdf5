#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

#include <poll.h>
#include <unistd.h>

#include "fuzz/case_maker.h"
#include "fuzz/workplace.h"
#include "pbrt/core/progress.h"
#include "pbrt/core/version.h"

#ifdef __SANITIZE_ADDRESS__
// A finding ends the case. The limit is on the memory used, because the address space cannot be limited.
extern "C" const char *__asan_default_options() {
    return "abort_on_error=0:detect_leaks=0:allocator_may_return_null=0:hard_rss_limit_mb=3000:"
           "max_allocation_size_mb=3000:detect_stack_use_after_return=0:exitcode=99";
}
extern "C" const char *__ubsan_default_options() { return "halt_on_error=1:print_stacktrace=1:exitcode=99"; }
#endif

namespace {

namespace fs = std::filesystem;
using namespace pbrt::fuzz;

struct Settings {
    uint64_t seed = 1, cases = 1000, from = 0;
    int jobs = 1, shrinkTries = 400;
    double minutes = 0;
    std::vector<std::string> only;
    std::string out, replay;
    bool verbose = false;
    Limits limits;
};

/// The temporary folder of this run, in memory if there is a file system in memory.
class Scratch {
  public:
    Scratch() {
        const fs::path base =
            fs::exists("/dev/shm") && access("/dev/shm", W_OK) == 0 ? "/dev/shm" : fs::temp_directory_path();
        folder_ = base / ("pbrt-fuzz-" + std::to_string(getpid()));
        fs::create_directories(folder_ / "assets");
    }
    ~Scratch() {
        std::error_code ignored;
        if (getpid() == owner_) fs::remove_all(folder_, ignored);
    }
    Scratch(const Scratch &) = delete;
    Scratch &operator=(const Scratch &) = delete;
    std::string Path(const std::string &name) const { return (folder_ / name).string(); }

  private:
    fs::path folder_;
    pid_t owner_ = getpid();
};

void Print(uint64_t number, const FuzzCase &fuzzCase, const CaseResult &result) {
    fmt::print("{}: {} of {}: {} {} ({:.3f} s)\n{}", number, fuzzCase.kind, fuzzCase.seed, Name(result.verdict.outcome),
               result.verdict.cause, result.run.seconds, result.run.messages);
}

const std::vector<std::string> &KindsOf(const Settings &s, const CaseMaker &maker) {
    return s.only.empty() ? maker.Kinds() : s.only;
}

/// Runs cases, several at the same time with --jobs, until all are done or the time is over.
Tally RunCases(const Settings &s, const CaseMaker &maker, const Scratch &scratch) {
    struct Seat {
        std::unique_ptr<Workplace> place;
        uint64_t number = 0;
        FuzzCase fuzzCase;
    };
    std::vector<Seat> seats(s.jobs);
    for (size_t i = 0; i < seats.size(); ++i)
        seats[i].place = std::make_unique<Workplace>(scratch.Path("job" + std::to_string(i)));
    const uint64_t end = s.from + s.cases;

    Tally tally;
    tally.seed = s.seed;
    tally.from = s.from;
    tally.version = pbrt::VersionText();
    const auto start = std::chrono::steady_clock::now();
    auto shown = start;
    uint64_t next = s.from;
    for (bool busy = true; busy;) {
        busy = false;
        const bool isTimeOver = s.minutes > 0 && pbrt::SecondsSince(start) > 60 * s.minutes;
        std::vector<pollfd> ends;
        for (Seat &seat : seats) {
            if (seat.place->Running())
                if (auto result = seat.place->Poll()) {
                    tally.Add(seat.number, seat.fuzzCase, result->verdict);
                    if (s.verbose) Print(seat.number, seat.fuzzCase, *result);
                }
            if (!seat.place->Running() && next < end && !isTimeOver) {
                seat.number = next++;
                seat.fuzzCase = maker.Make(s.seed, seat.number, KindsOf(s, maker));
                seat.place->Start(seat.fuzzCase, s.limits);
            }
            if (!seat.place->Running()) continue;
            busy = true;
            ends.push_back({seat.place->EndDescriptor(), POLLIN, 0});
        }
        if (!ends.empty()) poll(ends.data(), ends.size(), 20);
        if (pbrt::SecondsSince(shown) > 10) {
            shown = std::chrono::steady_clock::now();
            fmt::print(stderr, "{} cases, {:.1f} ms each, {} failures of {} causes\n", tally.cases,
                       1000 * pbrt::SecondsSince(start) / double(tally.cases), tally.Failures(), tally.causes.size());
        }
    }
    tally.seconds = pbrt::SecondsSince(start);
    return tally;
}

/// Saves one case of every cause, in its original and in its reduced form.
void SaveFailures(const Settings &s, const CaseMaker &maker, const Scratch &scratch, Tally &tally) {
    const fs::path failures = fs::path(s.out) / "failures";
    fs::remove_all(failures);
    fs::create_directories(failures);
    fs::copy(scratch.Path("assets"), failures / "assets", fs::copy_options::recursive);
    Workplace place(scratch.Path("shrink"));
    int index = 0;
    for (auto &[name, cause] : tally.causes) {
        const FuzzCase original = maker.Make(s.seed, cause.firstNumber, KindsOf(s, maker));
        const CaseResult first = place.Run(original, s.limits);
        const bool isSlow = first.run.wasTerminated;
        // A state with a part left out has another checksum.
        const int tries = original.kind == "state" ? 0 : isSlow ? std::min(s.shrinkTries, 30) : s.shrinkTries;
        const FuzzCase small = Shrink(
            original,
            [&](const FuzzCase &candidate) {
                const CaseResult again = place.Run(candidate, s.limits);
                return again.verdict.outcome == first.verdict.outcome && again.verdict.cause == first.verdict.cause;
            },
            tries);
        cause.folder = (failures / fmt::format("{:03}", index++)).string();
        const CaseResult last = place.Run(small, s.limits);
        SaveCase(cause.folder, small, last.verdict, last.run.messages);
        fmt::print("{}\n    {} times, first in case {} of {}; replay: fuzz --replay {}/case.json\n", name, cause.count,
                   cause.firstNumber, original.seed, cause.folder);
    }
}

int Replay(const Settings &s, const Scratch &scratch) {
    const FuzzCase fuzzCase = ReadCase(s.replay);
    Workplace place(scratch.Path("replay"));
    const CaseResult result = place.Run(fuzzCase, s.limits);
    fmt::print("{}{}: {} (exit status {}, signal {}, {:.2f} s)\n", result.run.messages, Name(result.verdict.outcome),
               result.verdict.cause, result.run.status, result.run.signal, result.run.seconds);
    for (const std::string &function : OurFunctions(result.run.frames))
        if (!function.empty()) fmt::print("    {}\n", function);
    return IsFailure(result.verdict.outcome) ? 1 : 0;
}

}  // namespace

int main(int argc, char **argv) {
    Settings s;
    CLI::App app(
        "Runs pbrt on mutated scenes and files, each in a child process, and sorts the outcomes.\n"
        "Exit status 1 if any case failed. See docs/develop/testing.md.",
        "fuzz");
    app.add_option("--seed", s.seed, "seed of all mutations (1)");
    app.add_option("--cases", s.cases, "number of cases (1000)");
    app.add_option("--from", s.from, "number of the first case (0)");
    app.add_option("--jobs", s.jobs, "cases at the same time (1)")->check(CLI::Range(1, 256));
    app.add_option("--minutes", s.minutes, "minutes after which no further case starts (0: no limit)");
    app.add_option("--only", s.only, "kinds of mutations, separated by commas (all)")->delimiter(',');
    app.add_option("--out", s.out, "folder for report.md and the failures, made smaller");
    app.add_option("--replay", s.replay, "run one saved case (its case.json)");
    app.add_flag("--verbose", s.verbose, "print every case with its messages");
    app.add_option("--seconds", s.limits.seconds, "CPU seconds for a case (4)");
    app.add_option("--memory-mb", s.limits.memoryMb, "megabytes of memory for a case (2048)");
    app.add_option("--shrink-tries", s.shrinkTries, "runs to make a failing case smaller (400)");
    CLI11_PARSE(app, argc, argv);
    try {
        const Scratch scratch;
        PrepareProgram(scratch.Path("assets"));
        const CaseMaker maker(Corpus::Load(scratch.Path("assets")));
        for (const std::string &kind : s.only)
            if (std::ranges::count(maker.Kinds(), kind) == 0)
                throw std::runtime_error(
                    fmt::format("there is no mutation \"{}\"; there are: {}", kind, fmt::join(maker.Kinds(), " ")));
        if (!s.replay.empty()) return Replay(s, scratch);
        Tally tally = RunCases(s, maker, scratch);
        if (!s.out.empty()) {
            SaveFailures(s, maker, scratch, tally);
            std::ofstream(fs::path(s.out) / "report.md") << Markdown(tally);
        }
        fmt::print("{}", Markdown(tally));
        return tally.causes.empty() ? 0 : 1;
    } catch (const std::exception &e) {
        fmt::print(stderr, "Error: {}\n", e.what());
        return 2;
    }
}
