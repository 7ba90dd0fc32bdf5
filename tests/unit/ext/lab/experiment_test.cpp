#include "ext/lab/experiment.h"

#include <algorithm>

#include "experiment_fixture.h"
#include "pbrt/images/image.h"

namespace ext::lab {

// Keys and types are those of the schemas (docs.scripting).
TEST_F(Experiment, LeavesFilesAndResults) {
    const ExperimentOutcome outcome = Run(Settings("out", {"uniform", "power", "honest"}));
    for (const char *name :
         {"results.json", "results.csv", "rounds.csv", "reference-0.exr", "reference-0.png", "uniform/seed0.exr",
          "power/seed1.exr", "honest/result.png", "honest/error.png", "records/uniform/seed0-round00.json"})
        EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
    const Json r = ReadJson(folder_ / "out/results.json");
    EXPECT_EQ(r, outcome.results);
    const Json expected = {{"schema", 2}, {"sceneName", "scene"}, {"mode", "samples"},      {"budget", 4},
                           {"seeds", 2},  {"maxDepth", 2},        {"resolution", {32, 24}}, {"direct", false}};
    for (const auto &[key, value] : expected.items()) EXPECT_EQ(r.at(key), value) << key;
    for (const Json &sentence : r.at("conclusion").at("sentences"))
        EXPECT_NE(outcome.text.find(sentence.get<std::string>()), std::string::npos) << sentence;
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
                for (const auto &[name, value] : round.at("metrics").items()) EXPECT_GT(value.get<double>(), 0) << name;
            }
        }
        // The summary is about the last rounds.
        double mean = 0;
        for (const Json &run : s.at("runs"))
            mean += run.at("rounds").back().at("metrics").at("relL2").get<double>() / 2;
        EXPECT_NEAR(s.at("summary").at("metrics").at("relL2").at("mean").get<double>(), mean, 1e-12);
    }
    EXPECT_EQ(SummaryOf(outcome, 2).at("leaves"), 7);
    EXPECT_EQ(SamplerOf(outcome, 2).at("structure"), "nothing learned");
    EXPECT_EQ(SummaryOf(outcome, 0).at("relativeCost"), 1);
    EXPECT_NE(outcome.text.find("honest"), std::string::npos);
}

TEST_F(Experiment, InspectsEverySampler) {
    const ExperimentOutcome outcome = Run(Settings("out", {"power", "honest", "uniform"}));
    const auto names = [&](const Json &views) {
        std::vector<std::string> list;
        for (const Json &layer : views.at("layers")) {
            list.push_back(layer.at("name"));
            // A layer that is the same everywhere has no picture.
            EXPECT_EQ(layer.at("file").is_null(), layer.at("isFlat").get<bool>()) << layer;
            if (layer.at("isFlat")) continue;
            // The picture has the size of the experiment's pictures, so that it can lie over them.
            const fs::path file = folder_ / "out" / layer.at("file").get<std::string>();
            EXPECT_EQ(ReadImage(file.string()).image.Resolution(), Point2i(32, 24)) << file;
        }
        return list;
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(names(SamplerOf(outcome, 0).at("views")),
              (Names{"entropy", "brightest_probability", "log10_excess", "path.vertices"}));
    EXPECT_EQ(names(SamplerOf(outcome, 1).at("views")),
              (Names{"sampler.side", "entropy", "brightest_probability", "log10_excess", "path.vertices"}));
    Names ofScene = names(outcome.results.at("views"));
    std::sort(ofScene.begin(), ofScene.end());
    EXPECT_EQ(ofScene, (Names{"brightest", "visibility.0", "visibility.1", "visibility.2"}));
    // All three lights have the same probability.
    const Json &entropy = SamplerOf(outcome, 2).at("views").at("layers").at(0);
    EXPECT_NEAR(entropy.at("min").get<double>(), std::log2(3.0), 1e-5);
    EXPECT_NEAR(entropy.at("max").get<double>(), std::log2(3.0), 1e-5);
    EXPECT_EQ(entropy.at("isFlat"), true);
    EXPECT_FALSE(fs::exists(folder_ / "out/uniform/views/entropy.png"));
    EXPECT_FALSE(fs::exists(folder_ / "out/uniform/views/sampler.side.png"));
}

TEST_F(Experiment, InspectionIsNoPartOfTheMeasurement) {
    ExperimentSettings settings = Settings("without", {"power", "honest"});
    settings.views = false;
    const ExperimentOutcome without = Run(settings);
    EXPECT_FALSE(without.results.contains("views"));
    EXPECT_FALSE(SamplerOf(without, 1).contains("views"));
    EXPECT_FALSE(fs::exists(folder_ / "without/honest/views"));
    const ExperimentOutcome with = Run(Settings("with", {"power", "honest"}));
    ExpectSamePictures("without", "with", {"power", "honest"}, 2);
    for (size_t i = 0; i < 2; ++i)
        EXPECT_EQ(SummaryOf(with, i).at("shadowRays"), SummaryOf(without, i).at("shadowRays"));
    // The views of a finished experiment can be made later, with the same result.
    settings.views = true;
    EXPECT_EQ(SamplerOf(Run(settings), 1).at("views"), SamplerOf(with, 1).at("views"));
    for (const char *file : {"honest/views/sampler.side.png", "views/brightest.png"})
        ExpectSamePixels(folder_ / "with" / file, folder_ / "without" / file);
}

TEST_F(Experiment, ErrorsAndVerdictsDoNotDependOnTheExposure) {
    auto run = [&](const std::string &name) {
        ExperimentSettings settings = Settings(name, {"uniform", "power", "blind"});
        settings.samplesPerPixel = 16;
        settings.referenceSamples = 256;
        return Run(settings);
    };
    // The floor has a mean radiance of about 0.1, so an absolute epsilon of 0.01 would matter.
    const ExperimentOutcome plain = run("plain");
    std::string scene = ThreeLights();
    for (size_t at = 0; (at = scene.find("\"rgb I\"", at)) != std::string::npos; at += 25)
        scene.insert(at, "\"float scale\" 100 ");
    Write("scene.pbrt", scene);
    const ExperimentOutcome bright = run("bright");
    for (size_t i = 0; i < 3; ++i) {
        const Json &a = SummaryOf(plain, i), &b = SummaryOf(bright, i);
        for (const char *measure : {"relL2", "relL2Trimmed"}) {
            const double one = a.at("metrics").at(measure).at("mean"), other = b.at("metrics").at(measure).at("mean");
            EXPECT_GT(one, 0.001);
            EXPECT_NEAR(other / one, 1, 1e-3) << i << " " << measure;
        }
        EXPECT_EQ(a.at("bias").at("verdict"), b.at("bias").at("verdict"));
        EXPECT_EQ(a.at("firefliesDecide"), b.at("firefliesDecide"));
    }
    EXPECT_EQ(plain.results.at("conclusion").at("lowestError"), bright.results.at("conclusion").at("lowestError"));
    const Json &references = plain.results.at("references");
    for (size_t i = 0; i < references.size(); ++i)
        EXPECT_NEAR(bright.results.at("references").at(i).at("noise").get<double>() /
                        references.at(i).at("noise").get<double>(),
                    1, 1e-3);
    // One pilot, so one choice of the samplers of the references.
    const Json pilot = ReadJson(folder_ / "plain/records/pilot.json").at("note");
    for (const Json &e : ReadJson(folder_ / "bright/records/pilot.json").at("note"))
        for (const Json &o : pilot)
            if (o.at("sampler") == e.at("sampler")) {
                EXPECT_NEAR(e.at("variance").get<double>() / o.at("variance").get<double>(), 1, 1e-3);
            }
}

TEST_F(Experiment, BiasedSamplerIsDetectedAndNeverWins) {
    ExperimentSettings settings = Settings("out", {"uniform", "blind", "honest"});
    settings.samplesPerPixel = 32;
    settings.seeds = 4;
    settings.referenceSamples = 1024;
    auto verdict = [](const ExperimentOutcome &outcome, size_t i) {
        return SummaryOf(outcome, i).at("bias").at("verdict").get<std::string>();
    };
    const ExperimentOutcome outcome = Run(settings);
    EXPECT_NE(verdict(outcome, 0), "biased");
    EXPECT_EQ(verdict(outcome, 1), "biased");
    EXPECT_NE(verdict(outcome, 2), "biased");
    EXPECT_NE(outcome.results.at("conclusion").at("lowestError"), "blind");
    // The blind sampler has the least noise, but the pilot sees what it lacks.
    EXPECT_NE(ReadJson(folder_ / "out/records/pilot.json").at("note").at(0).at("sampler"), "blind");
    EXPECT_EQ(outcome.results.at("conclusion").at("doubts").size(), 0u);

    // Lamps under the floor make noise for all samplers but "clever", which leaves them out, and a weak lamp, too. The
    // lamp is so weak that the pilot cannot see the loss; but the references contradict each other.
    std::string scene = ThreeLights();
    scene.replace(scene.find("[ 4 4 3 ]"), 9, "[ .4 .4 .4 ]");
    for (int i = 0; i < 20; ++i) scene += Objects().PointLight(fmt::format("{} -2 0", i % 4 - 2), "4 4 4");
    Write("scene.pbrt", scene);
    AddSampler("clever", 21);
    settings.samplers = ParseSamplerChoices({"uniform", "clever", "honest"}, registry_);
    settings.outFolder = Path("little");
    const ExperimentOutcome little = Run(settings);
    EXPECT_EQ(ReadJson(folder_ / "little/records/pilot.json").at("note").at(0).at("sampler"), "clever");
    for (const Json &r : little.results.at("references")) EXPECT_NE(r.at("sampler"), "clever");
    const Json &remarks = little.results.at("conclusion").at("remarks");
    ASSERT_GE(remarks.size(), 1u);
    EXPECT_NE(remarks.at(0).get<std::string>().find("one is biased"), std::string::npos) << remarks;
    EXPECT_EQ(verdict(little, 1), "biased");
    EXPECT_NE(little.results.at("conclusion").at("lowestError"), "clever");
}

// Power and bvh spend half of their samples on a lamp behind the wall. Uniform chooses one of the two strong lamps
// twice in 4,002 samples: in most pixels never, and its few hits are thousands of times too bright.
TEST_F(Experiment, SamplerOfRareHitsIsNotTakenForAQuietOne) {
    Objects world;
    for (const char *x : {"-1", "1"}) world.PointLight(fmt::format("{} 0 0", x), "4 4 4");
    for (int i = 0; i < 4000; ++i) world.PointLight(fmt::format("0 9 {}", i), "1e-6 1e-6 1e-6");
    world.Quad("0 -2 -9  0 -2 9  0 2 -9  0 2 9").Quad("-4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4");
    Write("scene.pbrt", ViewOf(world));
    Run(Settings("out", {"uniform", "power"}));
    const Json pilot = ReadJson(folder_ / "out/records/pilot.json").at("note");
    ASSERT_EQ(pilot.size(), 3u);
    EXPECT_EQ(pilot.at(2).at("sampler"), "uniform") << pilot.dump();
    EXPECT_GT(pilot.at(2).at("variance").get<double>(), 10 * pilot.at(1).at("variance").get<double>());
}

TEST_F(Experiment, RatiosAreToTheFirstOracle) {
    AddSampler("meter", 0, {.isInstrument = true});
    AddSampler("rough", 1, {.isInstrument = true});
    ExperimentSettings settings = Settings("out", {"uniform", "meter", "rough"});
    settings.samplesPerPixel = 1;
    settings.views = false;
    const ExperimentOutcome outcome = Run(settings);
    const auto error = [&](size_t i) {
        return SummaryOf(outcome, i).at("metrics").at("relL2").at("mean").get<double>();
    };
    for (size_t i : {0, 1, 2})
        EXPECT_NEAR(SummaryOf(outcome, i).at("ratioToOracle").get<double>(), error(i) / error(1), 1e-6) << i;
    EXPECT_NE(error(1), error(2));
}

TEST_F(Experiment, ComparesGuidedPathsWithPlainOnes) {
    // Paths that end at their second vertex have no roulette.
    std::string scene = ThreeLights();
    scene.replace(scene.find("maxdepth\" 2"), 11, "maxdepth\" 4");
    Write("scene.pbrt", scene);
    ExperimentSettings settings = Settings("out", {"honest", "honest+guide"});
    settings.samplesPerPixel = 16;  // the guide learns after 2 and 8
    Run(settings);
    const Image plain = ReadImage(Path("out/honest/seed0.exr")).image,
                guided = ReadImage(Path("out/honest+guide/seed0.exr")).image;
    ASSERT_EQ(plain.Bytes(), guided.Bytes());
    EXPECT_NE(std::memcmp(plain.Data(), guided.Data(), plain.Bytes()), 0);
}

TEST_F(Experiment, ReferenceOfAnotherResolutionIsAnError) {
    ExperimentSettings settings = Settings("out", {"uniform"});
    settings.referenceFile = Path("wrong.exr");
    WriteImage(settings.referenceFile, Image(PixelFormat::Float, {16, 16}, {"R", "G", "B"}));
    ExpectError([&] { Run(settings); }, {"16 x 16"});
}

}  // namespace ext::lab
