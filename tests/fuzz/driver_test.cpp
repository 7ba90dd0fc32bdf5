// Tests of the driver: it must recognise every kind of failure, make failing cases smaller, and make correct cases.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <set>

#include "fuzz/case_maker.h"
#include "fuzz/workplace.h"

/// A fault three functions deep. Outside the driver's namespace, whose functions no cause names, so that
/// the cause is the same whoever calls it.
namespace fault {
[[gnu::noinline]] int InnerWriteToNull() {
    volatile int *volatile nowhere = nullptr;  // volatile, so that the compiler keeps the access
    *nowhere = 1;
    return *nowhere;
}
[[gnu::noinline]] int MiddleWriteToNull() { return InnerWriteToNull() + 1; }
[[gnu::noinline]] int WriteToNull() { return MiddleWriteToNull() + 1; }
}  // namespace fault

namespace pbrt::fuzz {
namespace {

class Driver : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = std::filesystem::temp_directory_path() / ("pbrt_fuzz_test_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_ / "assets");
        PrepareProgram((folder_ / "assets").string());
        maker_ = std::make_unique<CaseMaker>(Corpus::Load((folder_ / "assets").string()));
    }
    static void TearDownTestSuite() {
        maker_.reset();
        std::filesystem::remove_all(folder_);
    }
    static std::string Folder(const char *name) { return (folder_ / name).string(); }

    /// The driver's verdict on a program that does this and has this exit status.
    static Verdict VerdictOn(int status, const std::function<void(PictureReport &)> &act) {
        Limits limits;
        limits.seconds = limits.graceSeconds = 0.3;
        limits.memoryMb = 300;
        Workplace place(Folder("job"), [&](const FuzzCase &, PictureReport &report) {
            act(report);
            return status;
        });
        return place.Run({"none", "none", {{"scene.pbrt", "WorldBegin\n"}}, {}}, limits).verdict;
    }
    /// Expects this outcome of a program that makes no picture; returns the cause.
    static std::string Expect(Outcome expected, int status, const std::function<void()> &act) {
        const Verdict verdict = VerdictOn(status, [&](PictureReport &) { act(); });
        EXPECT_EQ(verdict.outcome, expected) << verdict.cause;
        return verdict.cause;
    }
    /// As pbrt after an error with this message.
    static std::string ExpectAfterError(Outcome expected, const std::string &message) {
        SCOPED_TRACE(message);
        return Expect(expected, 1, [&] { std::fprintf(stderr, "Error: %s\n", message.c_str()); });
    }
    /// As pbrt after success.
    static Verdict AfterWriting(Float value) {
        return VerdictOn(0, [&](PictureReport &report) {
            Image image(PixelFormat::Float, {4, 3}, {"R", "G", "B"});
            image.Set({1, 2}, 1, value);
            WriteImage("out.exr", image);
            CheckImage("out.exr", report);
        });
    }
    static const CaseMaker &Maker() { return *maker_; }

  private:
    static inline std::filesystem::path folder_;
    static inline std::unique_ptr<CaseMaker> maker_;
};

int RecurseForEver(int n);
/// Read again at every call, so that the compiler cannot see that the recursion has no end.
int (*volatile recurse)(int) = RecurseForEver;
int RecurseForEver(int n) {
    volatile char room[1000];
    room[n % 1000] = char(n);
    return recurse(n + 1) + room[n % 500];
}
void KeepBusy() {
    for (std::atomic<int> i = 0;;) ++i;
}

TEST_F(Driver, DetectsCrashesAndNamesTheirPlace) {
    const std::string fault = Expect(Outcome::Signal, 0, [] { ::fault::WriteToNull(); });
    EXPECT_TRUE(fault.find("Segmentation fault") != std::string::npos) << fault;
    Expect(Outcome::Signal, 0, [] { RecurseForEver(0); });
    EXPECT_NE(Expect(Outcome::Signal, 0, [] { std::abort(); }), fault);
}

TEST_F(Driver, SeparatesHangsFromCasesThatStopOnCancel) {
    Expect(Outcome::Hang, 0, [] {
        std::signal(SIGTERM, SIG_IGN);
        KeepBusy();
    });
    Expect(Outcome::Hang, 0, [] {
        std::signal(SIGTERM, SIG_IGN);
        for (;;) pause();  // without using the processor
    });
    Expect(Outcome::Stopped, 0, [] {
        std::signal(SIGTERM, [](int) { _exit(143); });
        KeepBusy();
    });
}

TEST_F(Driver, DetectsMemoryThatNoMessageNames) {
    // The memory is not written to: the limit is on addresses, and a slow machine would need all the time
    // that the driver gives only to fill it.
    auto allocate = [] {
        std::vector<std::unique_ptr<char[]>> all;
        for (;;) all.push_back(std::make_unique_for_overwrite<char[]>(10 << 20));
    };
    Expect(Outcome::Memory, 0, allocate);
    Expect(Outcome::Memory, 1, [&] {
        try {
            allocate();
        } catch (const std::exception &e) {
            std::fprintf(stderr, "Error: %s\n", e.what());
        }
    });
    ExpectAfterError(Outcome::Memory, "scene.pbrt:3:4: std::bad_alloc");
}

TEST_F(Driver, JudgesMessages) {
    for (const char *message :
         {"scene.pbrt:12:3: \"float fov\" must be less than 180.", "mutated.ply: line 3: \"x\" is not a count.",
          "scene.pbrt:1:2: expected numbers, found \"bad_index\"."})
        ExpectAfterError(Outcome::Refused, message);
    for (const char *message :
         {"the number is too large.", "scene.pbrt:1:2: vector::_M_default_append", "Internal error: no device"})
        ExpectAfterError(Outcome::Message, message);
    for (int status : {1, 3}) Expect(Outcome::Silent, status, [] {});
    Expect(Outcome::Message, 1, [] {
        for (int i = 0; i < 30000; ++i)
            std::fprintf(stderr, "Error: scene.pbrt:%d:0: the same again, and again, and again\n", i);
    });
    // The same mistake at another place and with other values has the same cause.
    const std::string odd = ExpectAfterError(Outcome::Message, "value 12.5e3 of \"radius\" is odd");
    EXPECT_EQ(ExpectAfterError(Outcome::Message, "value -7 of \"zmin\" is odd"), odd);
    EXPECT_NE(ExpectAfterError(Outcome::Message, "value 3 of \"radius\" is even"), odd);
}

TEST_F(Driver, DetectsFindingsOfSanitizers) {
    Expect(Outcome::Sanitizer, 99, [] {
        std::fprintf(stderr,
                     "==7==ERROR: AddressSanitizer: heap-buffer-overflow on address 0x60\n"
                     "SUMMARY: AddressSanitizer: heap-buffer-overflow /x/ply.cpp:12 in pbrt::ParsePly\n");
    });
    Expect(Outcome::Sanitizer, 0,
           [] { std::fprintf(stderr, "/x/film.cpp:12:7: runtime error: signed integer overflow: 2147483647 + 1\n"); });
}

TEST_F(Driver, ChecksImages) {
    EXPECT_EQ(AfterWriting(2).outcome, Outcome::Rendered);
    EXPECT_EQ(AfterWriting(std::numeric_limits<Float>::quiet_NaN()).outcome, Outcome::Picture);
    EXPECT_EQ(AfterWriting(std::numeric_limits<Float>::infinity()).outcome, Outcome::Picture);
    const auto look = [](PictureReport &report) { CheckImage("out.exr", report); };
    EXPECT_EQ(VerdictOn(0, look).outcome, Outcome::Silent);
    const auto writeText = [](PictureReport &report) {
        std::ofstream("out.exr") << "not a picture";
        CheckImage("out.exr", report);
    };
    EXPECT_EQ(VerdictOn(0, writeText).outcome, Outcome::Picture);
    for (const char *name : {"out.exr", "out.tmp123.exr"})
        Expect(Outcome::Picture, 1, [&] {
            std::ofstream{name} << "half of it";
            std::fprintf(stderr, "Error: scene.pbrt:1:0: something is wrong\n");
        });
}

TEST_F(Driver, ShrinksWhatFailsForTheSameReason) {
    // Fails if both words are present, in any order; one of them is in the second file.
    auto program = [](const FuzzCase &fuzzCase, PictureReport &) {
        const bool both = fuzzCase.files[0].bytes.find("alpha") != std::string::npos &&
                          fuzzCase.files[1].bytes.find('\x7f') != std::string::npos;
        if (both) ::fault::WriteToNull();
        std::fprintf(stderr, "Error: scene.pbrt:1:0: something is wrong\n");
        return 1;
    };
    FuzzCase big{"none", "none", {{"scene.pbrt", ""}, {"mutated.ply", std::string(5000, '\0')}}, {"--a", "--b"}};
    for (int i = 0; i < 200; ++i)
        big.files[0].bytes += "line " + std::to_string(i) + (i == 77 ? " alpha and more\n" : " of many\n");
    big.files[1].bytes[1234] = '\x7f';
    Workplace place(Folder("job"), program);
    const Verdict first = place.Run(big, {}).verdict;
    ASSERT_EQ(first.outcome, Outcome::Signal);
    int tries = 0;
    auto fails = [&](const FuzzCase &c) {
        ++tries;
        return place.Run(c, {}).verdict.cause == first.cause;
    };
    const FuzzCase small = Shrink(big, fails, 300);
    EXPECT_EQ(small.files[0].bytes, "alpha ");
    EXPECT_LT(small.files[1].bytes.size(), 100u);
    EXPECT_NE(small.files[1].bytes.find('\x7f'), std::string::npos);
    EXPECT_TRUE(small.arguments.empty());
    tries = 0;
    EXPECT_EQ(place.Run(Shrink(big, fails, 5), {}).verdict.cause, first.cause);
    EXPECT_LE(tries, 6);
}

TEST_F(Driver, SavedCasesAreReadBack) {
    FuzzCase original = Maker().Make(1, 5, {"exr"});
    SaveCase(Folder("saved"), original, {Outcome::Signal, "somewhere"}, "messages");
    const FuzzCase again = ReadCase(Folder("saved") + "/case.json");
    ASSERT_EQ(again.files.size(), original.files.size());
    for (size_t i = 0; i < again.files.size(); ++i) {
        EXPECT_EQ(again.files[i].name, original.files[i].name);
        EXPECT_EQ(again.files[i].bytes, original.files[i].bytes);
    }
    EXPECT_EQ(again.arguments, original.arguments);
    EXPECT_EQ(again.output, original.output);
}

TEST_F(Driver, CasesFollowFromSeedAndNumberAndDiffer) {
    for (const std::string &kind : Maker().Kinds()) {
        std::set<std::string> contents;
        for (uint64_t n = 0; n < 20; ++n) {
            const FuzzCase a = Maker().Make(3, n, {kind}), b = Maker().Make(3, n, {kind});
            EXPECT_EQ(a.kind, kind);
            std::string one, other;
            for (const CaseFile &f : a.files) one += f.bytes;
            for (const CaseFile &f : b.files) other += f.bytes;
            ASSERT_EQ(one, other);
            EXPECT_EQ(a.arguments, b.arguments);
            contents.insert(one);
        }
        EXPECT_GE(contents.size(), 15u) << kind;
    }
}

TEST_F(Driver, KindsCoverEveryFormat) {
    const std::vector<std::string> &kinds = Maker().Kinds();
    for (const std::string &kind :
         WordsOf("bsdf exr hdr include include-gz lens pfm ply-ascii ply-binary ply-gz png spectrum tga scene-bytes "
                 "scene-names scene-nesting scene-numbers scene-parameters scene-splice scene-statements scene-types"))
        EXPECT_NE(std::find(kinds.begin(), kinds.end(), kind), kinds.end()) << kind;
}

TEST_F(Driver, SeedsRenderUnchanged) {
    size_t rendered = 0;
    Workplace place(Folder("job"));
    for (const SeedScene &scene : Maker().Seeds().scenes) {
        if (!scene.isRendered) continue;
        const CaseResult result = place.Run(Maker().Unchanged(scene), {});
        EXPECT_LE(result.verdict.outcome, Outcome::Warned) << scene.name << ": " << result.run.messages;
        ++rendered;
    }
    EXPECT_GT(rendered, 80u);
}

TEST_F(Driver, StatesAreReadUnchanged) {
    Workplace place(Folder("job"));
    for (const StateSeed &state : Maker().Seeds().states) {
        const CaseResult result = place.Run(UnchangedCase(state), {});
        EXPECT_LE(result.verdict.outcome, Outcome::Warned) << state.name << ": " << result.run.messages;
        EXPECT_FALSE(RendersReferenceAgain(result.run)) << result.run.messages;
    }
}

TEST_F(Driver, AnAcceptedChangeOfAStructureIsAFailure) {
    Workplace place(Folder("job"));
    for (const StateSeed *state : {&Maker().Seeds().states.front(), &Maker().Seeds().states.back()}) {
        FuzzCase unchanged = UnchangedCase(*state);
        unchanged.mustBeRefused = true;
        EXPECT_EQ(place.Run(unchanged, {}).verdict.outcome, Outcome::Accepted) << state->name;
    }
    int marked = 0;
    for (uint64_t i = 0; i < 200; ++i) marked += Maker().Make(1, i, {"state"}).mustBeRefused;
    EXPECT_GT(marked, 40);
    EXPECT_LT(marked, 160);
}

TEST_F(Driver, EveryAssetIsNamedByASeed) {
    std::set<std::string> named;
    for (const SeedScene &scene : Maker().Seeds().scenes)
        if (scene.isRendered) named.insert(scene.assets.begin(), scene.assets.end());
    for (const CaseFile &asset : MakeAssets(Folder("assets"))) EXPECT_TRUE(named.contains(asset.name)) << asset.name;
}

}  // namespace
}  // namespace pbrt::fuzz
