// Tests the wave loop with an integrator that only records its passes.
#include "pbrt/integrators/wave_renderer.h"

#include <csignal>
#include <set>

#include "pbrt/core/online_model.h"
#include "support/errors.h"
#include "support/folder_test.h"
#include "support/small_files.h"
#include "support/team_on_threads.h"
#include "support/temporary_image.h"
#include "support/test_clock.h"
#include "support/wait.h"
#include "unit/pbrt/films/film_fixtures.h"

namespace pbrt::test {
namespace {

/// Learns after the given numbers of samples.
class ListedLearner final : public OnlineModel {
  public:
    explicit ListedLearner(std::vector<int> at) : at_(std::move(at)) {}
    int NextUpdate() const override { return next_ < at_.size() ? at_[next_] : 0; }
    void Update(const Progress &) override { ++next_; }
    void ExtractRecords(StateWriter &) override {}
    void MergeRecords(StateReader &) override {}

  private:
    std::vector<int> at_;
    size_t next_ = 0;
};

struct Pass {
    int round = 0, firstOfAll = 0, count = 0;
    bool keepsSamples = true, isCounted = true;
    bool operator==(const Pass &) const = default;
};

/// A sampler whose SamplesPerPixel() is its seed; counts how often WithSeed() is called.
class SeedSampler final : public Sampler {
  public:
    SeedSampler(int seed, int *made) : Sampler(SamplerSettings{.samplesPerPixel = seed, .seed = seed}), made_(made) {}
    Point2 GetPixel2D() override { return {}; }
    std::unique_ptr<Sampler> Clone() const override { return std::make_unique<SeedSampler>(*this); }
    std::unique_ptr<Sampler> WithSeed(int seed) const override {
        ++*made_;
        return std::make_unique<SeedSampler>(seed, made_);
    }

  protected:
    int StartSample(Point2i, int, int dimension) override { return dimension; }
    Run Prepare(int dimension, Numbers &numbers) override {
        numbers = {};
        return {dimension, kPrepared};
    }

  private:
    int *made_;
};

/// Records the passes and the seeds; every sample is 1 at every wavelength.
class Recorder final : public Integrator {
  public:
    explicit Recorder(TestClock &clock) : clock_(clock) {}
    bool Render(const RenderPass &pass) override {
        passes.push_back({pass.batchFirst / pass.samplesPerPixel, pass.batchFirst + pass.first, pass.count,
                          pass.keepsSamples, pass.isCounted});
        seeds.insert(pass.samplers[0]->SamplesPerPixel());
        for (const auto &s : pass.samplers) EXPECT_EQ(s->SamplesPerPixel(), pass.samplers[0]->SamplesPerPixel());
        if (passes.size() == cancelsIn) {
            pass.progress.Cancel();
            return false;
        }
        clock_.Advance(secondsPerSample * pass.count);
        FilmSample sample;
        for (int i = 0; i < pass.count; ++i) {
            sample.lambda = pass.film.SampleWavelengths(0.5f);
            sample.L = SampledSpectrum(1);
            pass.film.AddSample(sample);
        }
        return true;
    }
    OnlineModel *Model() override { return learner.get(); }
    std::vector<int> Counts() const {
        std::vector<int> counts;
        for (const Pass &p : passes) counts.push_back(p.count);
        return counts;
    }

    std::vector<Pass> passes;
    std::set<int> seeds;  ///< the seeds of the samplers that were used
    std::unique_ptr<ListedLearner> learner;
    size_t cancelsIn = 0;  ///< the pass that cancels the render, counted from 1; 0: none
    std::chrono::duration<double> secondsPerSample{};

  private:
    TestClock &clock_;
};

class RenderLoop : public test::FolderTest {
  protected:
    RenderLoop() {
        DiagnosticSink sink;
        filter_ = Filters().Make("box", ParamSet(), FilterContext{sink});
        camera_ = Cameras().Make("orthographic", ParamSet(), CameraContext{Transform(), {}, 35, {}, sink});
    }
    RenderContext ContextOf(Integrator &integrator, Film &film, Team &team = Team::Alone()) {
        return {integrator, *camera_, *filter_, film, sampler_, progress_, team};
    }
    RenderContext Context() { return ContextOf(integrator_, *film_); }
    RenderResult Run() { return RenderWaves(Context(), settings_); }
    std::string WriteReference(int size, Float value) const {
        WriteImage(Path("reference.exr"), RgbImage({size, size}, [&](int, int) { return Rgb(value); }));
        return Path("reference.exr");
    }

    const std::unique_ptr<Film> film_ = MakeFullFloat("rgb", FilmSize(1, 1));
    std::unique_ptr<Filter> filter_;
    std::unique_ptr<Camera> camera_;
    TestClock clock_;
    Recorder integrator_{clock_};
    RenderSettings settings_;
    Progress progress_{nullptr, std::ref(clock_)};
    int batches_ = 0;  ///< batches that were begun after the first one
    const SeedSampler sampler_{5, &batches_};
};

TEST(SamplePlan, IsRoundedToFourStepsAnOctave) {
    EXPECT_EQ(FittingSamples(4, 4.0 / 64), 64);
    EXPECT_EQ(FittingSamples(4, 4.0 / 68), 64);
    EXPECT_EQ(FittingSamples(4, 4.0 / 75), 76);
    EXPECT_EQ(FittingSamples(4, 10), 1);
    EXPECT_EQ(FittingSamples(-1, 10), 1);
    EXPECT_EQ(FittingSamples(4, 0), FittingSamples(1e9, 1e-9));  // the largest
}

TEST_F(RenderLoop, SecondsPerSampleAreMeasuredOnAScratchFilm) {
    integrator_.secondsPerSample = std::chrono::milliseconds(20);
    settings_.timeBudget = 5;
    EXPECT_NEAR(MeasureSecondsPerSample(Context(), settings_, 5), 0.02, 1e-9);
    EXPECT_EQ(integrator_.Counts(), (std::vector<int>{1, 1, 2, 4})) << "until 0.1 s are over";
}

/// Takes a millisecond for every pixel of a film, until it is cancelled.
class MillisecondPixels final : public Integrator {
  public:
    explicit MillisecondPixels(TestClock &clock) : clock_(clock) {}
    bool Render(const RenderPass &pass) override {
        for (int64_t i = 0; i < pass.film.PixelBounds().Area(); ++i) {
            if (pass.progress.Cancelled()) return false;
            clock_.Advance(std::chrono::milliseconds(1));
            pass.progress.Advance();
        }
        return true;
    }

  private:
    TestClock &clock_;
};

TEST_F(RenderLoop, TheMeasurementStopsInTheMiddleOfALongSample) {
    const std::unique_ptr<Film> film = MakeFullFloat("rgb", FilmSize(32, 32));
    MillisecondPixels integrator(clock_);
    const auto start = clock_();
    EXPECT_NEAR(MeasureSecondsPerSample(ContextOf(integrator, *film), settings_, 1), 1.024, 1e-6);
    EXPECT_LE(clock_() - start, std::chrono::milliseconds(101));
}

TEST_F(RenderLoop, WavesDoubleUpToTheLargest) {
    settings_.samplesPerPixel = 300;
    std::vector<int> seen;
    settings_.afterWave = [&](const RenderResult &until) { seen.push_back(until.samplesTaken); };
    const RenderResult result = Run();
    EXPECT_EQ(integrator_.Counts(), (std::vector<int>{1, 1, 2, 4, 8, 16, 32, 64, 64, 64, 44}));
    EXPECT_EQ(seen, (std::vector<int>{1, 2, 4, 8, 16, 32, 64, 128, 192, 256, 300}));
    EXPECT_EQ(result.samplesTaken, 300);
    EXPECT_FALSE(result.cancelled);
    EXPECT_EQ(integrator_.seeds, std::set<int>{5});
    for (const Pass &p : integrator_.passes) EXPECT_TRUE(p.keepsSamples && p.isCounted);
}

TEST_F(RenderLoop, NoPassCrossesTheEndOfABatch) {
    settings_.samplesPerPixel = 4;
    WaveRenderer renderer(Context(), settings_);
    std::vector<int> taken;
    for (int i = 0; i < 4; ++i) taken.push_back(renderer.Render(3));
    EXPECT_EQ(taken, (std::vector<int>{3, 1, 3, 1}));
    EXPECT_EQ(integrator_.passes, (std::vector<Pass>{{0, 0, 3}, {0, 3, 1}, {1, 4, 3}, {1, 7, 1}}));
    EXPECT_EQ(batches_, 1);
    EXPECT_EQ(integrator_.seeds.size(), 2u);
    EXPECT_EQ(renderer.Done(), 8);
}

TEST_F(RenderLoop, LearningHappensAfterTheSamplesThatTheLearnerNames) {
    settings_.samplesPerPixel = 20;
    integrator_.learner = std::make_unique<ListedLearner>(std::vector<int>{1, 6, 7});
    Run();
    EXPECT_EQ(integrator_.Counts(), (std::vector<int>{1, 1, 2, 2, 1, 13}));
    EXPECT_EQ(integrator_.learner->NextUpdate(), 0);
}

TEST_F(RenderLoop, LearningBeforeAWaveIsDoneOnce) {
    settings_.samplesPerPixel = 20;
    integrator_.learner = std::make_unique<ListedLearner>(std::vector<int>{2, 5});
    WaveRenderer renderer(Context(), settings_);
    renderer.UpdateIfDue();
    EXPECT_EQ(integrator_.learner->NextUpdate(), 2);
    EXPECT_EQ(renderer.Render(9), 2);
    EXPECT_EQ(integrator_.learner->NextUpdate(), 2);
    renderer.UpdateIfDue();
    renderer.UpdateIfDue();
    EXPECT_EQ(integrator_.learner->NextUpdate(), 5);
    EXPECT_EQ(renderer.Render(9), 3);
}

TEST_F(RenderLoop, ResumingRepeatsOnlyWhatIsLearnedFrom) {
    settings_.samplesPerPixel = 32;
    integrator_.learner = std::make_unique<ListedLearner>(std::vector<int>{1, 6});
    WaveRenderer renderer(Context(), settings_);
    renderer.ContinueFrom(10);
    EXPECT_EQ(renderer.Done(), 10);
    EXPECT_EQ(renderer.Render(5), 5);
    EXPECT_EQ(
        integrator_.passes,
        (std::vector<Pass>{{0, 0, 1, false, false}, {0, 1, 5, false, false}, {0, 6, 4, false, false}, {0, 10, 5}}));

    integrator_.learner = nullptr;
    integrator_.passes.clear();
    WaveRenderer unlearned(Context(), settings_);
    unlearned.ContinueFrom(70);
    unlearned.Render(1);
    EXPECT_EQ(integrator_.passes, (std::vector<Pass>{{2, 70, 1}}));
}

TEST_F(RenderLoop, ACancelledPassIsNotCounted) {
    settings_.samplesPerPixel = 16;
    int waves = 0;
    settings_.afterWave = [&](const RenderResult &) { ++waves; };
    integrator_.cancelsIn = 3;
    const RenderResult result = Run();
    EXPECT_TRUE(result.cancelled);
    EXPECT_EQ(result.samplesTaken, 2);
    EXPECT_EQ(waves, 2);
    // After the cancellation the integrator is not called again.
    const RenderResult again = Run();
    EXPECT_TRUE(again.cancelled);
    EXPECT_EQ(again.samplesTaken, 0);
    EXPECT_EQ(integrator_.passes.size(), 3u);
}

/// One of two processes that render two parts: the first begins one, then the second begins the other.
struct OneOfTwo : RenderLoop, Integrator {
    OneOfTwo(Team &team, Mail &mail, std::atomic<int> &begun, bool isCancelled)
        : team_(team), mail_(mail), begun_(begun), isCancelled_(isCancelled) {
        settings_.samplesPerPixel = 1;
    }
    void TestBody() override {}
    bool Render(const RenderPass &pass) override {
        const auto waitUntil = [&](int begun) { EXPECT_TRUE(WaitUntil([&] { return begun_ >= begun; })); };
        const auto isAnswered = [&] { return mail_.IsWaiting(1, MessagePort::Channel::Replies); };
        const bool isFirst = pass.team.IsRank0();
        if (!isFirst) waitUntil(1);
        return RenderChunks(pass, {.count = 2,
                                   .samplesOf = [](int64_t) { return 1u; },
                                   .render =
                                       [&](int64_t, uint32_t) {
                                           ++begun_;
                                           waitUntil(2);
                                           if (isFirst || !isCancelled_) return 1u;
                                           // The first has answered that there is no other part.
                                           EXPECT_TRUE(WaitUntil(isAnswered));
                                           progress_.Cancel();
                                           return 0u;
                                       }});
    }
    RenderResult Run() { return RenderWaves(ContextOf(*this, *film_, team_), settings_); }
    void Follow() { FollowWaves(ContextOf(*this, *film_, team_), settings_); }

    Team &team_;
    Mail &mail_;
    std::atomic<int> &begun_;
    const bool isCancelled_;
};

TEST(RenderLoopOfProcesses, OneThatIsCancelledInItsLastPartCancelsTheRender) {
    ThreadLimit oneEach(1);
    for (const bool isCancelled : {false, true}) {
        std::atomic<int> begun = 0;
        Mail mail;
        WithTeam(mail, 2, [&](Team &team) {
            OneOfTwo process(team, mail, begun, isCancelled);
            if (!team.IsRank0()) return process.Follow();
            const RenderResult result = process.Run();
            EXPECT_EQ(result.cancelled, isCancelled);
            EXPECT_EQ(result.samplesTaken, isCancelled ? 0 : 1);
        });
    }
}

TEST_F(RenderLoop, ATimeBudgetEndsTheRenderAndItsLastWaveFits) {
    settings_.samplesPerPixel = 4;
    settings_.timeBudget = 0.5;
    settings_.start = clock_();
    integrator_.secondsPerSample = std::chrono::milliseconds(10);
    const RenderResult result = Run();
    EXPECT_FALSE(result.cancelled);
    EXPECT_EQ(result.samplesTaken, 50);
    EXPECT_NEAR(result.seconds, 0.5, 1e-9);
    EXPECT_EQ(integrator_.seeds.size(), 13u);
    for (const Pass &p : integrator_.passes) EXPECT_FALSE(p.isCounted);
    // With a budget that is used up already, one sample is rendered all the same.
    integrator_.passes.clear();
    EXPECT_EQ(Run().samplesTaken, 1);
}

TEST_F(RenderLoop, EveryWaveIsComparedWithTheReference) {
    settings_.samplesPerPixel = 4;
    settings_.mseReferenceImage = WriteReference(1, 0.25f);
    settings_.mseReferenceOut = Path("errors.txt");
    const RenderResult result = Run();
    EXPECT_EQ(result.mseFailure, "");
    const Image image = film_->ToImage();
    double expected = 0;
    for (int c = 0; c < 3; ++c) expected += Sqr(double(image.Get({0, 0}, c)) - 0.25) / 3;
    ASSERT_TRUE(result.mse);
    EXPECT_NEAR(*result.mse, expected, 1e-6 * expected);
    std::ifstream in(settings_.mseReferenceOut);
    std::vector<int> samples;
    int n = 0;
    char comma = 0;
    for (double mse = 0; in >> n >> comma >> mse; samples.push_back(n))
        EXPECT_NEAR(mse, expected, 1e-6 * expected) << n;
    EXPECT_EQ(samples, (std::vector<int>{1, 2, 4}));
}

TEST_F(RenderLoop, AFullDiskCostsTheErrorsButNotTheRender) {
    settings_.samplesPerPixel = 4;
    settings_.mseReferenceImage = WriteReference(1, 1);
    settings_.mseReferenceOut = Path("errors.txt");
    // Without this, writing beyond the limit would end the process.
    const auto before = std::signal(SIGXFSZ, SIG_IGN);
    const RenderResult result = [&] {
        const SmallFilesOnly full(5);
        return Run();
    }();
    std::signal(SIGXFSZ, before);
    EXPECT_EQ(result.samplesTaken, 4);
    EXPECT_TRUE(result.mse);
    ExpectWords(result.mseFailure, {"errors.txt: cannot be written"});
}

TEST_F(RenderLoop, AReferenceMustCoverTheFilm) {
    settings_.mseReferenceImage = WriteReference(1, 1);
    settings_.mseReferenceOut = Path("nowhere/errors.txt");
    EXPECT_THROW(Run(), UserError);
    settings_.mseReferenceOut = Path("errors.txt");
    EXPECT_NO_THROW(Run());
    WriteReference(2, 1);
    EXPECT_THROW(Run(), UserError);
    WriteReference(1, 1);
    ImageMetadata elsewhere;
    elsewhere.pixelBounds = Bounds2i{{1, 0}, {2, 1}};
    WriteImage(Path("reference.exr"), ReadImage(Path("reference.exr")).image, elsewhere);
    EXPECT_THROW(Run(), UserError);
}

}  // namespace
}  // namespace pbrt::test
