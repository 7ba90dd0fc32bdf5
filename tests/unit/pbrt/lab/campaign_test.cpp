#include "pbrt/lab/campaign.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "pbrt/core/log.h"
#include "pbrt/images/image.h"
#include "pbrt/lab/campaign_display.h"
#include "pbrt/lab/reference_cache.h"
#include "pbrt/scenefile/content_hash.h"

namespace pbrt::lab {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Three point lights of similar strength over a floor.
const char *const kScene = R"(LookAt 0 3 -6  0 0 0  0 1 0
Camera "perspective" "float fov" 40
Film "rgb" "integer xresolution" 32 "integer yresolution" 24 "string filename" "scene.exr"
Sampler "independent" "integer pixelsamples" 4
Integrator "path" "integer maxdepth" 2
WorldBegin
LightSource "point" "point3 from" [ -2 2 0 ] "rgb I" [ 4 4 4 ]
LightSource "point" "point3 from" [ 0 2 1 ] "rgb I" [ 3 3 4 ]
LightSource "point" "point3 from" [ 2 2 0 ] "rgb I" [ 4 4 3 ]
Material "diffuse" "rgb reflectance" [ 0.6 0.4 0.3 ]
Shape "sphere" "float radius" 0.7
Shape "bilinearmesh" "point3 P" [ -4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4 ]
)";

/// Shared by the samplers that a registry makes; the campaign is cancelled when `callsLeft` reaches 0.
struct Switch {
    std::atomic<int64_t> callsLeft{1 << 30};
    Progress *progress = nullptr;
};

/// Uniform over all lights but the last `blind` ones. Cancels the campaign after a number of calls.
class TestSampler final : public LightSampler {
  public:
    TestSampler(size_t lights, size_t blind, std::shared_ptr<Switch> interrupt)
        : seen_(lights - blind), interrupt_(std::move(interrupt)) {}
    std::optional<SampledLight> Choose(const LightQuery &, const void *, Float u, Point2 *) const override {
        if (--interrupt_->callsLeft == 0) interrupt_->progress->Cancel();
        auto i = std::min(static_cast<size_t>(u * static_cast<Float>(seen_)), seen_ - 1);
        return SampledLight{LightId(i), 1 / static_cast<Float>(seen_)};
    }
    Float Probability(const LightQuery &, const void *, LightId light) const override {
        return light.value < seen_ ? 1 / static_cast<Float>(seen_) : 0;
    }
    void Report(nlohmann::ordered_json &report) const override { report["leaves"] = 7; }
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override {
        values.push_back({"side", query.p.x > 0 ? 1.0 : 2.0, true});
    }
    std::string DescribeStructure() const override { return "nothing learned"; }

  private:
    size_t seen_;
    std::shared_ptr<Switch> interrupt_;
};

Json ReadJson(const fs::path &path) {
    std::ifstream in(path);
    return Json::parse(in);
}

/// Expects that both files have pixels of equal bits.
void ExpectSamePixels(const fs::path &a, const fs::path &b) {
    const Image one = ReadImage(a.string()).image, two = ReadImage(b.string()).image;
    ASSERT_EQ(one.Bytes(), two.Bytes());
    ASSERT_GT(one.Bytes(), 0u);
    EXPECT_EQ(std::memcmp(one.Data(), two.Data(), one.Bytes()), 0) << a << " " << b;
}

class Campaign : public ::testing::Test {
  protected:
    void SetUp() override {
        SetLogLevel(LogLevel::Error);
        const auto *info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ =
            fs::temp_directory_path() / (std::string("pbrt_campaign_") + info->name() + "_" + std::to_string(getpid()));
        fs::create_directories(folder_);
        WriteScene("", "");
        RegisterStockLightSamplers(registry_);
        AddSampler("honest", 0);
        AddSampler("blind", 1);
    }
    /// The scene with a part of its text replaced.
    void WriteScene(const std::string &part, const std::string &other) {
        const std::string text = kScene;
        std::ofstream(folder_ / "scene.pbrt") << std::string(text).replace(text.find(part), part.size(), other);
    }
    void TearDown() override {
        fs::remove_all(folder_);
        SetLogLevel(LogLevel::Info);
    }
    void AddSampler(const std::string &name, size_t blind) {
        auto make = [blind, interrupt = switch_](NoParams, const ParamSet &, const LightGroups &groups) {
            return std::make_unique<TestSampler>(groups.LightCount(), blind, interrupt);
        };
        registry_.samplers.Add<NoParams>(name, "of the test", make);
    }
    CampaignSettings Settings(const std::string &out, const std::vector<std::string> &samplers) {
        CampaignSettings s;
        s.scene = (folder_ / "scene.pbrt").string();
        s.samplers = ParseSamplerChoices(samplers, registry_);
        s.samplesPerPixel = 4;
        s.seeds = 2;
        s.referenceSamples = 32;
        s.selectionWork = 1e5;
        s.outFolder = (folder_ / out).string();
        s.cacheFolder = (folder_ / "cache").string();
        return s;
    }
    std::optional<CampaignOutcome> Run(const CampaignSettings &settings) {
        Progress progress;
        switch_->progress = &progress;
        return RunCampaign(settings, registry_, progress, nullptr);
    }
    std::string ErrorOf(const CampaignSettings &settings) {
        try {
            Run(settings);
        } catch (const UserError &e) {
            return e.what();
        }
        return "";
    }
    void ExpectSamePictures(const std::string &a, const std::string &b, const std::vector<std::string> &samplers,
                            int seeds) {
        for (const std::string &sampler : samplers)
            for (int seed = 0; seed < seeds; ++seed) {
                const std::string name = SafeFileName(sampler) + "/seed" + std::to_string(seed) + ".exr";
                ExpectSamePixels(folder_ / a / name, folder_ / b / name);
            }
        ExpectSamePixels(folder_ / a / "reference-0.exr", folder_ / b / "reference-0.exr");
    }

    std::vector<fs::path> ReferencesIn(const std::string &folder) const {
        std::vector<fs::path> found;
        for (const auto &entry : fs::directory_iterator(folder_ / folder))
            if (entry.path().filename().string().starts_with("scene.reference-")) found.push_back(entry.path());
        std::sort(found.begin(), found.end());
        return found;
    }

    fs::path folder_;
    LightSamplerRegistry registry_;
    std::shared_ptr<Switch> switch_ = std::make_shared<Switch>();
};

}  // namespace

TEST_F(Campaign, LeavesEverythingTheSchemaNames) {
    const std::optional<CampaignOutcome> outcome = Run(Settings("out", {"uniform", "power", "honest"}));
    ASSERT_TRUE(outcome);
    for (const char *name :
         {"results.json", "results.csv", "rounds.csv", "reference-0.exr", "reference-0.png", "uniform/seed0.exr",
          "power/seed1.exr", "honest/result.png", "honest/error.png", "records/uniform/seed0-round00.json"})
        EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
    const Json r = ReadJson(folder_ / "out/results.json");
    EXPECT_EQ(r, outcome->results);
    EXPECT_EQ(r.at("schema"), 2);
    EXPECT_EQ(r.at("sceneName"), "scene");
    EXPECT_EQ(r.at("sceneHash").get<std::string>().size(), 16u);
    EXPECT_EQ(r.at("mode"), "samples");
    EXPECT_EQ(r.at("budget"), 4);
    EXPECT_EQ(r.at("seeds"), 2);
    EXPECT_EQ(r.at("resolution"), Json({32, 24}));
    EXPECT_EQ(r.at("maxDepth"), 2);
    EXPECT_EQ(r.at("direct"), false);
    for (const char *key : {"commit", "commandLine", "date"}) EXPECT_TRUE(r.contains(key)) << key;
    for (const char *key : {"cpu", "threads", "memoryGB", "os"}) EXPECT_TRUE(r.at("machine").contains(key)) << key;
    for (const char *key : {"winner", "lowestError", "level", "headline", "reasons", "doubts", "remarks", "sentences"})
        EXPECT_TRUE(r.at("conclusion").contains(key)) << key;
    EXPECT_TRUE(r.at("conclusion").at("lowestError").is_string());
    for (const Json &sentence : r.at("conclusion").at("sentences"))
        EXPECT_NE(outcome->text.find(sentence.get<std::string>()), std::string::npos) << sentence;
    ASSERT_GE(r.at("references").size(), 1u);
    for (const Json &reference : r.at("references")) {
        EXPECT_TRUE(fs::exists(folder_ / "out" / reference.at("file").get<std::string>()));
        EXPECT_TRUE(fs::exists(folder_ / "out" / reference.at("picture").get<std::string>()));
        EXPECT_EQ(reference.at("samples"), 32);
        EXPECT_GT(reference.at("seconds").get<double>(), 0);
        EXPECT_GT(reference.at("noise").get<double>(), 0);
    }
    ASSERT_GE(r.at("crops").size(), 1u);
    for (const Json &c : r.at("crops")) {
        EXPECT_GE(c.at("x0").get<int>(), 0);
        EXPECT_LE(c.at("x1").get<int>(), 32);
        EXPECT_LE(c.at("y1").get<int>(), 24);
        EXPECT_LT(c.at("x0").get<int>(), c.at("x1").get<int>());
    }
    ASSERT_EQ(r.at("samplers").size(), 3u);
    for (const Json &s : r.at("samplers")) {
        // No sampler is judged by a reference from its own samples.
        EXPECT_NE(r.at("references").at(s.at("reference").get<size_t>()).at("sampler"), s.at("label"));
        ASSERT_EQ(s.at("runs").size(), 2u);
        for (const Json &run : s.at("runs")) {
            EXPECT_TRUE(fs::exists(folder_ / "out" / run.at("image").get<std::string>()));
            EXPECT_EQ(run.at("shadowRays").get<int>() > 0, true);
            ASSERT_EQ(run.at("rounds").size(), 3u);
            int samples = 1;
            double seconds = run.at("prepareSeconds").get<double>();
            for (const Json &round : run.at("rounds")) {
                EXPECT_EQ(round.at("samples"), samples);
                samples *= 2;
                EXPECT_GT(round.at("seconds").get<double>(), seconds);
                seconds = round.at("seconds").get<double>();
                EXPECT_GT(round.at("cpuSeconds").get<double>(), 0);
                for (const char *m : {"relL2", "MSE", "MRSE", "MAE", "SMAPE", "FLIP", "relL2Trimmed"})
                    EXPECT_GT(round.at("metrics").at(m).get<double>(), 0) << m;
            }
        }
        const Json &summary = s.at("summary");
        for (const char *key :
             {"samples", "seconds", "cpuSeconds", "firefliesDecide", "efficiency", "speedUp", "speedUpAgainst",
              "ratioToOracle", "leaves", "bytes", "shadowRays", "blockedShare", "relativeCost", "preparationShare"})
            EXPECT_TRUE(summary.contains(key)) << key;
        for (const char *key : {"prepassSeconds", "buildSeconds", "renderSeconds"})
            EXPECT_TRUE(summary.at("overhead").contains(key)) << key;
        for (const char *key : {"verdict", "tiles", "tests", "worstZ", "pValue", "meanDifference"})
            EXPECT_TRUE(summary.at("bias").contains(key)) << key;
        // The summary is about the last rounds.
        double mean = 0;
        for (const Json &run : s.at("runs"))
            mean += run.at("rounds").back().at("metrics").at("relL2").get<double>() / 2;
        EXPECT_NEAR(summary.at("metrics").at("relL2").at("mean").get<double>(), mean, 1e-12);
    }
    EXPECT_EQ(r.at("samplers").at(2).at("summary").at("leaves"), 7);
    EXPECT_EQ(r.at("samplers").at(2).at("structure"), "nothing learned");
    EXPECT_EQ(r.at("samplers").at(0).at("summary").at("relativeCost"), 1);
    EXPECT_NE(outcome->text.find("honest"), std::string::npos);
}

TEST_F(Campaign, LooksInsideEverySampler) {
    const std::optional<CampaignOutcome> outcome = Run(Settings("out", {"power", "honest", "uniform"}));
    ASSERT_TRUE(outcome);
    const auto names = [&](const Json &views) {
        std::vector<std::string> list;
        for (const Json &layer : views.at("layers")) {
            list.push_back(layer.at("name"));
            // A layer that is the same everywhere has no picture.
            EXPECT_EQ(layer.at("file").is_null(), layer.at("isFlat").get<bool>()) << layer;
            if (layer.at("isFlat")) continue;
            // The picture has the size of the campaign's pictures, so that it can lie over them.
            const fs::path file = folder_ / "out" / layer.at("file").get<std::string>();
            EXPECT_EQ(ReadImage(file.string()).image.Resolution(), Point2i(32, 24)) << file;
        }
        return list;
    };
    const Json &samplers = outcome->results.at("samplers");
    using Names = std::vector<std::string>;
    EXPECT_EQ(names(samplers.at(0).at("views")),
              (Names{"entropy", "brightest_probability", "log10_excess", "path.vertices"}));
    EXPECT_EQ(names(samplers.at(1).at("views")),
              (Names{"sampler.side", "entropy", "brightest_probability", "log10_excess", "path.vertices"}));
    Names ofScene = names(outcome->results.at("views"));
    std::sort(ofScene.begin(), ofScene.end());
    EXPECT_EQ(ofScene, (Names{"brightest", "visibility.0", "visibility.1", "visibility.2"}));
    // All three lights have the same probability.
    const Json &entropy = samplers.at(2).at("views").at("layers").at(0);
    EXPECT_NEAR(entropy.at("least").get<double>(), std::log2(3.0), 1e-5);
    EXPECT_NEAR(entropy.at("most").get<double>(), std::log2(3.0), 1e-5);
    EXPECT_EQ(entropy.at("isFlat"), true);
    EXPECT_FALSE(fs::exists(folder_ / "out/uniform/views/entropy.png"));
    // Lights are named by their position in the scene file.
    std::vector<std::string> lights;
    for (const Json &layer : outcome->results.at("views").at("layers"))
        if (layer.contains("light")) lights.push_back(layer.at("light"));
    std::sort(lights.begin(), lights.end());
    EXPECT_EQ(lights, (Names{"LightSource \"point\" at scene.pbrt:7", "LightSource \"point\" at scene.pbrt:8",
                             "LightSource \"point\" at scene.pbrt:9"}));
    EXPECT_FALSE(fs::exists(folder_ / "out/uniform/views/sampler.side.png"));
}

TEST_F(Campaign, LooksInsideAreNoPartOfTheMeasurement) {
    CampaignSettings settings = Settings("without", {"power", "honest"});
    settings.views = false;
    const std::optional<CampaignOutcome> without = Run(settings);
    ASSERT_TRUE(without);
    EXPECT_FALSE(without->results.contains("views"));
    EXPECT_FALSE(without->results.at("samplers").at(1).contains("views"));
    EXPECT_FALSE(fs::exists(folder_ / "without/honest/views"));
    ASSERT_TRUE(Run(Settings("with", {"power", "honest"})));
    ExpectSamePictures("without", "with", {"power", "honest"}, 2);
    const Json with = ReadJson(folder_ / "with/results.json");
    for (size_t i = 0; i < 2; ++i)
        EXPECT_EQ(with.at("samplers").at(i).at("summary").at("shadowRays"),
                  without->results.at("samplers").at(i).at("summary").at("shadowRays"));
    // The views of a finished campaign can be made later, with the same result.
    settings.views = true;
    const std::optional<CampaignOutcome> later = Run(settings);
    ASSERT_TRUE(later);
    EXPECT_EQ(later->results.at("samplers").at(1).at("views"), with.at("samplers").at(1).at("views"));
    for (const char *file : {"honest/views/sampler.side.png", "views/brightest.png"})
        ExpectSamePixels(folder_ / "with" / file, folder_ / "without" / file);
}

TEST_F(Campaign, RepeatGivesTheSamePictures) {
    const std::vector<std::string> samplers = {"uniform", "power"};
    ASSERT_TRUE(Run(Settings("one", samplers)));
    // Without the cache, the second campaign renders its reference again.
    fs::remove_all(folder_ / "cache");
    ASSERT_TRUE(Run(Settings("two", samplers)));
    ExpectSamePictures("one", "two", samplers, 2);
    // Different seeds give different pictures.
    const Image a = ReadImage((folder_ / "one/uniform/seed0.exr").string()).image;
    const Image b = ReadImage((folder_ / "one/uniform/seed1.exr").string()).image;
    EXPECT_NE(std::memcmp(a.Data(), b.Data(), a.Bytes()), 0);
}

TEST_F(Campaign, ReferenceIsKeptInTheCacheAndFoundAgain) {
    const std::optional<CampaignOutcome> first = Run(Settings("one", {"uniform"}));
    ASSERT_TRUE(first);
    const std::vector<fs::path> kept = ReferencesIn("cache");
    ASSERT_GE(kept.size(), 1u);
    for (const char *elsewhere : {"", "one"}) EXPECT_EQ(ReferencesIn(elsewhere).size(), 0u) << elsewhere;
    EXPECT_NE(first->text.find(kept[0].parent_path().string()), std::string::npos) << first->text;
    const auto time = fs::last_write_time(kept[0]);
    ASSERT_TRUE(Run(Settings("two", {"uniform"})));
    EXPECT_EQ(fs::last_write_time(kept[0]), time);
    // A reference file that was cut short is rendered again, with the same result.
    const auto size = fs::file_size(kept[0]);
    fs::resize_file(kept[0], size / 2);
    ASSERT_TRUE(Run(Settings("three", {"uniform"})));
    EXPECT_EQ(fs::file_size(kept[0]), size);
    ExpectSamePictures("one", "three", {"uniform"}, 2);
    // Another scene gets another reference.
    std::ofstream(folder_ / "scene.pbrt", std::ios::app) << "Shape \"sphere\" \"float radius\" 0.2\n";
    ASSERT_TRUE(Run(Settings("four", {"uniform"})));
    EXPECT_GT(ReferencesIn("cache").size(), kept.size());
}

TEST_F(Campaign, CacheThatCannotBeWrittenCostsTheCacheOnly) {
    fs::create_directory(folder_ / "protected");
    fs::rename(folder_ / "scene.pbrt", folder_ / "protected/scene.pbrt");
    fs::permissions(folder_ / "protected", fs::perms::owner_read | fs::perms::owner_exec);
    std::ofstream(folder_ / "file") << "in the way";
    // A file in place of the folder stops root as well, for whom permissions do not count.
    int run = 0;
    for (const std::string &cache : {std::string(), (folder_ / "file").string(), (folder_ / "file/below").string()}) {
        const std::string out = "out" + std::to_string(run++);
        CampaignSettings settings = Settings(out, {"uniform"});
        settings.scene = (folder_ / "protected/scene.pbrt").string();
        settings.cacheFolder = cache;
        const std::optional<CampaignOutcome> outcome = Run(settings);
        ASSERT_TRUE(outcome) << cache;
        EXPECT_EQ(ReferencesIn("protected").size(), 0u);
        EXPECT_GE(ReferencesIn(out).size(), 1u);
        EXPECT_NE(outcome->text.find((folder_ / out).string()), std::string::npos) << outcome->text;
    }
    fs::permissions(folder_ / "protected", fs::perms::owner_all);
}

TEST(ReferenceCache, DefaultFolderIsTheUsers) {
    const char *const names[] = {"XDG_CACHE_HOME", "HOME"};
    std::vector<std::optional<std::string>> before;
    for (const char *name : names)
        before.emplace_back(std::getenv(name) ? std::optional<std::string>(std::getenv(name)) : std::nullopt);
    setenv("XDG_CACHE_HOME", "/somewhere/cache", 1);
    setenv("HOME", "/home/me", 1);
    EXPECT_EQ(UserCacheFolder(), "/somewhere/cache/pbrt_octree");
    setenv("XDG_CACHE_HOME", "relative", 1);
    EXPECT_EQ(UserCacheFolder(), "/home/me/.cache/pbrt_octree");
    unsetenv("XDG_CACHE_HOME");
    EXPECT_EQ(UserCacheFolder(), "/home/me/.cache/pbrt_octree");
    unsetenv("HOME");
    EXPECT_EQ(UserCacheFolder(), "");
    for (size_t i = 0; i < 2; ++i)
        if (before[i]) setenv(names[i], before[i]->c_str(), 1);
}

TEST_F(Campaign, InterruptedOnesEndAsIfNothingHadHappened) {
    const std::vector<std::string> samplers = {"uniform", "honest"};
    switch_->callsLeft = 1 << 30;
    ASSERT_TRUE(Run(Settings("whole", samplers)));
    const int64_t calls = (1 << 30) - switch_->callsLeft;
    ASSERT_GT(calls, 1000);
    fs::remove_all(folder_ / "cache");
    // The campaign is interrupted during the pilot, the references and the rounds.
    int interruptions = 0;
    for (int attempt = 0; attempt < 40; ++attempt) {
        switch_->callsLeft = attempt < 12 ? calls / 5 : 1 << 30;
        if (Run(Settings("parts", samplers))) break;
        ++interruptions;
    }
    EXPECT_GE(interruptions, 3);
    ExpectSamePictures("whole", "parts", samplers, 2);
    const Json whole = ReadJson(folder_ / "whole/results.json"), parts = ReadJson(folder_ / "parts/results.json");
    for (size_t i = 0; i < 2; ++i) {
        const Json &a = whole.at("samplers").at(i).at("runs").at(1), &b = parts.at("samplers").at(i).at("runs").at(1);
        EXPECT_EQ(a.at("shadowRays"), b.at("shadowRays"));
        for (size_t r = 0; r < 3; ++r)
            EXPECT_EQ(a.at("rounds").at(r).at("metrics"), b.at("rounds").at(r).at("metrics"));
    }
    // A finished campaign is not rendered again, only summarised.
    const auto time = fs::last_write_time(folder_ / "parts/honest/seed1.exr");
    ASSERT_TRUE(Run(Settings("parts", samplers)));
    EXPECT_EQ(fs::last_write_time(folder_ / "parts/honest/seed1.exr"), time);
}

// Cuts or removes every file that a campaign keeps, both of a finished campaign and of one that was stopped while it
// rendered.
TEST_F(Campaign, GoesOnWhateverFileWasCutShort) {
    const std::vector<std::string> samplers = {"uniform", "honest"};
    const std::optional<CampaignOutcome> whole = Run(Settings("whole", samplers));
    ASSERT_TRUE(whole);
    // Another campaign is stopped in its rounds, after it has saved a film.
    auto hasFilm = [&] {
        for (const auto &entry : fs::recursive_directory_iterator(folder_ / "stopped"))
            if (entry.path().extension() == ".film") return true;
        return false;
    };
    for (int attempt = 0; attempt < 200; ++attempt) {
        // The pilot runs in one piece; after that a run stops in each round.
        switch_->callsLeft =
            fs::exists(folder_ / "stopped/records/pilot.json") ? 2000 + 100 * attempt : 3000 + 1000 * attempt;
        ASSERT_FALSE(Run(Settings("stopped", samplers)))
            << "the campaign ended before it was stopped with a film on disk";
        if (hasFilm()) break;
    }
    ASSERT_TRUE(hasFilm());
    switch_->callsLeft = 1 << 30;
    int films = 0, cuts = 0;
    for (const std::string campaign : {"whole", "stopped"}) {
        std::vector<std::string> files;
        for (const auto &entry : fs::recursive_directory_iterator(folder_ / campaign))
            if (entry.is_regular_file() &&
                (campaign == "whole" || entry.path().string().find("/records/") != std::string::npos))
                files.push_back(fs::relative(entry.path(), folder_ / campaign).string());
        for (const std::string &file : files) {
            const bool decides = file.find("records") == 0 || file.find("seed") != std::string::npos;
            films += file.ends_with(".film");
            const auto size = static_cast<int64_t>(fs::file_size(folder_ / campaign / file));
            // The length -1 removes the file.
            for (const int64_t length :
                 decides ? std::vector<int64_t>{-1, 0, size / 2, size - 3} : std::vector<int64_t>{size / 2}) {
                fs::remove_all(folder_ / "cut");
                fs::copy(folder_ / campaign, folder_ / "cut", fs::copy_options::recursive);
                if (length < 0) fs::remove(folder_ / "cut" / file);
                else fs::resize_file(folder_ / "cut" / file, static_cast<uintmax_t>(length));
                const std::optional<CampaignOutcome> outcome = Run(Settings("cut", samplers));
                ASSERT_TRUE(outcome) << campaign << " " << file << " " << length;
                ++cuts;
                ExpectSamePictures("whole", "cut", samplers, 2);
                for (size_t i = 0; i < samplers.size(); ++i) {
                    const Json &a = whole->results.at("samplers").at(i), &b = outcome->results.at("samplers").at(i);
                    EXPECT_EQ(a.at("summary").at("metrics"), b.at("summary").at("metrics"))
                        << campaign << " " << file << " " << length;
                    for (size_t seed = 0; seed < 2; ++seed) {
                        const Json &x = a.at("runs").at(seed).at("rounds"), &y = b.at("runs").at(seed).at("rounds");
                        ASSERT_EQ(x.size(), y.size()) << campaign << " " << file << " " << length;
                        for (size_t r = 0; r < x.size(); ++r) EXPECT_EQ(x.at(r).at("metrics"), y.at(r).at("metrics"));
                    }
                    for (const Json &layer : b.at("views").at("layers")) {
                        const std::string picture =
                            layer.at("file").is_string() ? layer.at("file") : "views/brightest.png";
                        EXPECT_NO_THROW(ReadImage((folder_ / "cut" / picture).string())) << file << " " << length;
                    }
                }
            }
        }
    }
    EXPECT_GE(films, 1);
    EXPECT_GE(cuts, 80);
}

TEST_F(Campaign, RecordsOfAnotherCampaignOrVersionAreNotTakenUp) {
    ASSERT_TRUE(Run(Settings("whole", {"uniform"})));
    CampaignSettings settings = Settings("out", {"uniform"});
    settings.samplesPerPixel = 8;
    ASSERT_TRUE(Run(settings));
    // The file with the settings of the records is lost, and the new settings differ.
    fs::remove(folder_ / "out/records/settings.json");
    ASSERT_TRUE(Run(Settings("out", {"uniform"})));
    ExpectSamePictures("whole", "out", {"uniform"}, 2);
    EXPECT_EQ(ReadJson(folder_ / "out/results.json").at("samplers").at(0).at("runs").at(0).at("rounds").size(), 3u);
    // A record that lacks a value which this version needs.
    const fs::path record = folder_ / "out/records/uniform/seed1-round02.json";
    Json json = ReadJson(record);
    json.erase("shadowRays");
    json["metrics"]["relL2"] = 0;
    std::ofstream(record) << json;
    ASSERT_TRUE(Run(Settings("out", {"uniform"})));
    EXPECT_EQ(ReadJson(record).at("metrics"),
              ReadJson(folder_ / "whole/records/uniform/seed1-round02.json").at("metrics"));
}

TEST_F(Campaign, MoreSeedsGoOnAndFewerAreAPart) {
    CampaignSettings settings = Settings("out", {"uniform"});
    settings.seeds = 2;
    ASSERT_TRUE(Run(settings));
    const auto time = fs::last_write_time(folder_ / "out/uniform/seed1.exr");
    settings.seeds = 3;
    const std::optional<CampaignOutcome> more = Run(settings);
    ASSERT_TRUE(more);
    EXPECT_EQ(fs::last_write_time(folder_ / "out/uniform/seed1.exr"), time);
    CampaignSettings afresh = settings;
    afresh.outFolder = (folder_ / "afresh").string();
    const std::optional<CampaignOutcome> whole = Run(afresh);
    ASSERT_TRUE(whole);
    const auto errors = [](const CampaignOutcome &o) {
        return o.results.at("samplers").at(0).at("summary").at("metrics");
    };
    EXPECT_EQ(errors(*more), errors(*whole));
    settings.seeds = 1;
    const std::optional<CampaignOutcome> fewer = Run(settings);
    ASSERT_TRUE(fewer);
    EXPECT_EQ(fewer->results.at("seeds"), 1);
    EXPECT_EQ(fewer->results.at("samplers").at(0).at("runs").size(), 1u);
}

TEST_F(Campaign, OtherSettingsInTheSameFolderAreRefusedUntilRestart) {
    CampaignSettings settings = Settings("out", {"uniform"});
    ASSERT_TRUE(Run(settings));
    settings.samplesPerPixel = 2;
    const std::string error = ErrorOf(settings);
    for (const char *part : {"spp", "4", "2", "--restart"}) EXPECT_NE(error.find(part), std::string::npos) << error;
    settings.restart = true;
    const std::optional<CampaignOutcome> outcome = Run(settings);
    ASSERT_TRUE(outcome);
    EXPECT_EQ(outcome->results.at("budget"), 2);
}

TEST_F(Campaign, SampleCountsOfATimedOneGiveTheSamePictures) {
    const std::vector<std::string> samplers = {"uniform", "power"};
    CampaignSettings timed = Settings("timed", samplers);
    timed.timeBudget = 0.1;
    const std::optional<CampaignOutcome> first = Run(timed);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->results.at("mode"), "time");
    for (const Json &s : first->results.at("samplers"))
        for (const Json &run : s.at("runs")) {
            EXPECT_GT(run.at("rounds").size(), 1u);
            // More samples than the four of the scene, so later batches are needed, too.
            EXPECT_GT(run.at("rounds").back().at("samples").get<int>(), 4);
        }
    CampaignSettings replay = Settings("replay", samplers);
    replay.timeBudget = 0.1;
    replay.samplesFrom = (folder_ / "timed/results.json").string();
    ASSERT_TRUE(Run(replay));
    ExpectSamePictures("timed", "replay", samplers, 2);
    replay.seeds = 3;
    replay.outFolder = (folder_ / "more").string();
    EXPECT_NE(ErrorOf(replay).find("seed 2"), std::string::npos);
}

TEST_F(Campaign, BiasedSamplerIsFoundAndNeverWins) {
    CampaignSettings settings = Settings("out", {"uniform", "blind", "honest"});
    settings.samplesPerPixel = 32;
    settings.seeds = 4;
    settings.referenceSamples = 1024;
    auto verdict = [](const CampaignOutcome &outcome, size_t i) {
        return outcome.results.at("samplers").at(i).at("summary").at("bias").at("verdict").get<std::string>();
    };
    const std::optional<CampaignOutcome> outcome = Run(settings);
    ASSERT_TRUE(outcome);
    EXPECT_NE(verdict(*outcome, 0), "biased");
    EXPECT_EQ(verdict(*outcome, 1), "biased");
    EXPECT_NE(verdict(*outcome, 2), "biased");
    EXPECT_NE(outcome->results.at("conclusion").at("lowestError"), "blind");
    // The blind sampler has the least noise, but the pilot sees what it lacks.
    EXPECT_NE(ReadJson(folder_ / "out/records/pilot.json").at("note").at(0).at("sampler"), "blind");
    EXPECT_EQ(outcome->results.at("conclusion").at("doubts").size(), 0u);

    // Lamps under the floor make noise for all samplers but "clever", which leaves them out, and a weak lamp, too. The
    // lamp is so weak that the pilot cannot see the loss; but the references contradict each other.
    std::string scene = kScene;
    scene.replace(scene.find("[ 4 4 3 ]"), 9, "[ .4 .4 .4 ]");
    for (int i = 0; i < 20; ++i)
        scene += fmt::format("LightSource \"point\" \"point3 from\" [ {} -2 0 ] \"rgb I\" [ 4 4 4 ]\n", i % 4 - 2);
    std::ofstream(folder_ / "scene.pbrt") << scene;
    AddSampler("clever", 21);
    settings.samplers = ParseSamplerChoices({"uniform", "clever", "honest"}, registry_);
    settings.outFolder = (folder_ / "little").string();
    const std::optional<CampaignOutcome> little = Run(settings);
    ASSERT_TRUE(little);
    EXPECT_EQ(ReadJson(folder_ / "little/records/pilot.json").at("note").at(0).at("sampler"), "clever");
    for (const Json &r : little->results.at("references")) EXPECT_NE(r.at("sampler"), "clever");
    const Json &remarks = little->results.at("conclusion").at("remarks");
    ASSERT_GE(remarks.size(), 1u);
    EXPECT_NE(remarks.at(0).get<std::string>().find("one is biased"), std::string::npos) << remarks;
    EXPECT_EQ(verdict(*little, 1), "biased");
    EXPECT_NE(little->results.at("conclusion").at("lowestError"), "clever");
}

// Power and bvh spend half of their samples on a lamp behind the wall. Uniform chooses one of the two strong lamps
// twice in 4,002 samples: in most pixels never, and its few hits are thousands of times too bright.
TEST_F(Campaign, SamplerOfRareHitsIsNotTakenForAQuietOne) {
    std::string scene = kScene;
    scene.resize(scene.find("LightSource"));
    for (const char *x : {"-1", "1"})
        scene += fmt::format("LightSource \"point\" \"point3 from\" [ {} 0 0 ] \"rgb I\" [ 4 4 4 ]\n", x);
    for (int i = 0; i < 4000; ++i)
        scene += fmt::format("LightSource \"point\" \"point3 from\" [ 0 9 {} ] \"rgb I\" [ 1e-6 1e-6 1e-6 ]\n", i);
    scene +=
        "Shape \"bilinearmesh\" \"point3 P\" [ 0 -2 -9  0 -2 9  0 2 -9  0 2 9 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ -4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4 ]\n";
    std::ofstream(folder_ / "scene.pbrt") << scene;
    ASSERT_TRUE(Run(Settings("out", {"uniform", "power"})));
    const Json pilot = ReadJson(folder_ / "out/records/pilot.json").at("note");
    ASSERT_EQ(pilot.size(), 3u);
    EXPECT_EQ(pilot.at(2).at("sampler"), "uniform") << pilot.dump();
    EXPECT_GT(pilot.at(2).at("variance").get<double>(), 10 * pilot.at(1).at("variance").get<double>());
}

// Uniform chooses the lamp once in 20,000 samples and finds the ceiling by BSDF samples, so its pictures are quiet but
// lack a light. The references have few samples. No stock sampler may be called biased for that.
TEST_F(Campaign, ReferencesOfStockThatContradictEachOtherProveNothing) {
    std::string scene = kScene;
    scene.resize(scene.find("LightSource"));
    scene += "LightSource \"point\" \"point3 from\" [ 0 2 0 ] \"rgb I\" [ 4 4 4 ]\n";
    for (int i = 0; i < 20000; ++i)
        scene += fmt::format("LightSource \"point\" \"point3 from\" [ 0 9 {} ] \"rgb I\" [ 1e-6 1e-6 1e-6 ]\n", i);
    scene +=
        "Shape \"bilinearmesh\" \"point3 P\" [ -4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4 ]\n"
        "AreaLightSource \"diffuse\" \"rgb L\" [ 1 1 1 ]\n"
        "Shape \"bilinearmesh\" \"point3 P\" [ -9 4 -9  -9 4 9  9 4 -9  9 4 9 ]\n";
    std::ofstream(folder_ / "scene.pbrt") << scene;
    CampaignSettings settings = Settings("out", {"uniform", "bvh"});
    settings.samplesPerPixel = 4;
    settings.seeds = 4;
    settings.referenceSamples = 16;
    settings.selectionWork = 0;
    const std::optional<CampaignOutcome> outcome = Run(settings);
    ASSERT_TRUE(outcome);
    bool wouldHaveBeen = false;
    for (const Json &s : outcome->results.at("samplers")) {
        const Json &bias = s.at("summary").at("bias");
        EXPECT_NE(bias.at("verdict"), "biased") << bias.dump();
        wouldHaveBeen = wouldHaveBeen || bias.at("text").get<std::string>().find("proves nothing") != std::string::npos;
    }
    EXPECT_TRUE(wouldHaveBeen);
    const Json &conclusion = outcome->results.at("conclusion");
    ASSERT_EQ(conclusion.at("doubts").size(), 1u) << conclusion.dump();
    EXPECT_NE(conclusion.at("doubts").at(0).get<std::string>().find("prove no bias"), std::string::npos)
        << conclusion.dump();
    // Such references rank no sampler, whichever seems to lead, and the terminal says so, too.
    EXPECT_TRUE(conclusion.at("winner").is_null()) << conclusion.dump();
    EXPECT_NE(outcome->text.find("prove no bias"), std::string::npos) << outcome->text;
}

TEST_F(Campaign, ComparesGuidedPathsWithPlainOnes) {
    // Paths that end at their second vertex have no roulette.
    WriteScene("maxdepth\" 2", "maxdepth\" 4");
    CampaignSettings settings = Settings("out", {"honest", "honest+guide"});
    settings.samplesPerPixel = 16;  // the guide learns after 2 and 8
    ASSERT_TRUE(Run(settings));
    const fs::path out = folder_ / "out";
    const Image plain = ReadImage((out / "honest/seed0.exr").string()).image,
                guided = ReadImage((out / "honest+guide/seed0.exr").string()).image;
    ASSERT_EQ(plain.Bytes(), guided.Bytes());
    EXPECT_NE(std::memcmp(plain.Data(), guided.Data(), plain.Bytes()), 0);
}

TEST_F(Campaign, MistakesAreFoundBeforeAnythingIsRendered) {
    EXPECT_THROW(ParseSamplerChoices({"uniform", "uniform"}, registry_), UserError);
    try {
        ParseSamplerChoices(
            {"nosuch", "power:leaves=3", "bvh+gate=nogate", "bvh+what", "bvh+guide:length=2", "uniform"}, registry_);
        FAIL();
    } catch (const UserError &e) {
        EXPECT_EQ(e.Diagnostics().size(), 5u);
        EXPECT_NE(e.Diagnostics()[0].message.find("uniform"), std::string::npos) << e.Diagnostics()[0].message;
    }
    CampaignSettings settings = Settings("out", {"uniform"});
    settings.crops = {{{0, 0}, {33, 8}}};
    EXPECT_NE(ErrorOf(settings).find("--crops"), std::string::npos);
    settings = Settings("out", {"uniform"});
    settings.referenceFile = (folder_ / "none.exr").string();
    EXPECT_NE(ErrorOf(settings), "");
    Image wrong(PixelFormat::Float, {16, 16}, {"R", "G", "B"});
    WriteImage((folder_ / "wrong.exr").string(), wrong);
    settings.referenceFile = (folder_ / "wrong.exr").string();
    EXPECT_NE(ErrorOf(settings).find("16 x 16"), std::string::npos) << ErrorOf(settings);
    WriteScene("\"path\"", "\"randomwalk\"");
    EXPECT_NE(ErrorOf(Settings("other", {"uniform"})).find("randomwalk"), std::string::npos);
}

TEST_F(Campaign, GivenReferenceIsUsedAsItIs) {
    ASSERT_TRUE(Run(Settings("one", {"power"})));
    CampaignSettings settings = Settings("two", {"uniform"});
    settings.referenceFile = (folder_ / "one/reference-0.exr").string();
    const std::optional<CampaignOutcome> outcome = Run(settings);
    ASSERT_TRUE(outcome);
    ExpectSamePixels(folder_ / "one/reference-0.exr", folder_ / "two/reference-0.exr");
    EXPECT_EQ(outcome->results.at("references").size(), 1u);
    EXPECT_FALSE(fs::exists(folder_ / "two/records/pilot.json"));
}

TEST(SamplerList, KeysBelongToTheSamplerBeforeThem) {
    EXPECT_EQ(SplitSamplerList("a,b:k=1,m=2,c+mesh,d+gate=g:k=1,m=2, e"),
              (std::vector<std::string>{"a", "b:k=1,m=2", "c+mesh", "d+gate=g:k=1,m=2", "e"}));
    EXPECT_EQ(SplitSamplerList("a+guide,b+guide:k=1,m=2,c"),
              (std::vector<std::string>{"a+guide", "b+guide:k=1,m=2", "c"}));
    EXPECT_EQ(SafeFileName("octree:leaves=64,floor=.2+gate=a/b"), "octree_leaves=64,floor=.2+gate=a_b");
}

TEST(Checkpoints, StartAtOneSampleAndEndAtTheBudget) {
    CampaignSettings settings;
    settings.samplesPerPixel = 24;
    std::vector<int> samples;
    for (const Checkpoint &c : Checkpoints(settings)) samples.push_back(c.samples);
    EXPECT_EQ(samples, (std::vector<int>{1, 2, 4, 8, 16, 24}));
    settings.samplesPerPixel = 1;
    EXPECT_EQ(Checkpoints(settings).size(), 1u);
    settings.timeBudget = 32;
    const std::vector<Checkpoint> timed = Checkpoints(settings);
    ASSERT_EQ(timed.size(), 8u);
    EXPECT_EQ(timed[0].samples, 1);
    EXPECT_EQ(timed[1].seconds, 0.5);
    EXPECT_EQ(timed[7].seconds, 32);
}

TEST(CampaignDisplay, TimeLeftIsThatOfTheWholeCampaign) {
    struct Sink final : ProgressSink {
        void Show(const std::string &p, double f, double e, double r) override {
            phase = p;
            fraction = f;
            elapsed = e;
            remaining = r;
        }
        void PhaseDone(const std::string &, double) override {}
        std::string phase;
        double fraction = -1, elapsed = 0, remaining = -2;
    } sink;
    CampaignDisplay display(&sink);
    auto show = [&](double left) {
        std::this_thread::sleep_for(std::chrono::milliseconds(210));  // the display is updated at most every 0.2 s
        display.Show(left);
    };
    display.SetPhase("pilot");
    show(-1);
    EXPECT_EQ(sink.phase, "pilot");
    EXPECT_EQ(sink.fraction, 0);
    EXPECT_LT(sink.remaining, 0);
    display.SetPhase("reference 0");
    display.SetAfter(3);
    show(2);
    EXPECT_EQ(sink.phase, "reference 0");
    EXPECT_EQ(sink.remaining, 5);
    EXPECT_NEAR(sink.fraction, sink.elapsed / (sink.elapsed + 5), 1e-12);
    display.SetAfter(0);
    show(0);
    EXPECT_EQ(sink.remaining, 0);
    EXPECT_EQ(sink.fraction, 1);
}

TEST(SceneHash, SeesEveryFileThatIsNamed) {
    const fs::path folder = fs::temp_directory_path() / ("pbrt_scene_hash_" + std::to_string(getpid()));
    fs::create_directories(folder);
    auto write = [&](const char *name, const std::string &text) { std::ofstream(folder / name) << text; };
    write("a.pbrt", "Include \"b.pbrt\"\n# \"c.ply\"\n");
    write("b.pbrt", "Shape \"plymesh\" \"string filename\" \"mesh.ply\"\n");
    write("mesh.ply", "one");
    write("c.ply", "comment");
    const std::string path = (folder / "a.pbrt").string(), hash = SceneHash(path);
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_EQ(SceneHash(path), hash);
    write("c.ply", "not read");
    EXPECT_EQ(SceneHash(path), hash);
    write("mesh.ply", "two");
    const std::string second = SceneHash(path);
    EXPECT_NE(second, hash);
    write("b.pbrt", "Shape \"plymesh\" \"string filename\" \"mesh.ply\" \n");
    EXPECT_NE(SceneHash(path), second);
    fs::remove_all(folder);
}

}  // namespace pbrt::lab
