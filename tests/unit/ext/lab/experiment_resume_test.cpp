#include <fstream>

#include "experiment_fixture.h"
#include "ext/lab/run_record.h"
#include "pbrt/images/image.h"

namespace ext::lab {

/// As of a timed run whose first sample takes longer than the first rounds.
TEST_F(Experiment, RoundsWithoutNewSamplesAreNoDamage) {
    fs::create_directories(folder_ / "records/honest");
    const RecordFolder records((folder_ / "records").string(), "key");
    RunRecord run;
    for (const int samples : {0, 4, 4, 3}) {
        RoundRecord &round = run.rounds.emplace_back();
        round.checkpoint = int(run.rounds.size()) - 1;
        round.samples = samples;
        records.SaveLastRound("honest", run);
    }
    EXPECT_EQ(records.LoadRun("honest", 0, 9).rounds.size(), 3u);
}

// Cuts or removes every file that an experiment keeps, both of a finished experiment and of one that was stopped while
// it rendered.
TEST_F(Experiment, ResumesWhateverFileWasCutShort) {
    const std::vector<std::string> samplers = {"uniform", "honest"};
    const ExperimentOutcome whole = Run(Settings("whole", samplers));
    // Another experiment is stopped in its rounds, after it has saved a film.
    auto hasFilm = [&] {
        for (const auto &entry : fs::recursive_directory_iterator(folder_ / "stopped"))
            if (entry.path().extension() == ".film") return true;
        return false;
    };
    for (int attempt = 0; attempt < 200; ++attempt) {
        // The pilot runs in one piece; after that a run stops in each round.
        switch_->callsLeft =
            fs::exists(folder_ / "stopped/records/pilot.json") ? 2000 + 100 * attempt : 3000 + 1000 * attempt;
        ASSERT_FALSE(TryToRun(Settings("stopped", samplers)))
            << "the experiment ended before it was stopped with a film on disk";
        if (hasFilm()) break;
    }
    ASSERT_TRUE(hasFilm());
    switch_->callsLeft = 1 << 30;
    int films = 0, cuts = 0;
    for (const std::string experiment : {"whole", "stopped"}) {
        std::vector<std::string> files;
        for (const auto &entry : fs::recursive_directory_iterator(folder_ / experiment))
            if (entry.is_regular_file() &&
                (experiment == "whole" || entry.path().string().find("/records/") != std::string::npos))
                files.push_back(fs::relative(entry.path(), folder_ / experiment).string());
        for (const std::string &file : files) {
            const bool decides = file.find("records") == 0 || file.find("seed") != std::string::npos;
            films += file.ends_with(".film");
            const auto size = int64_t(fs::file_size(folder_ / experiment / file));
            // The length -1 removes the file.
            for (const int64_t length :
                 decides ? std::vector<int64_t>{-1, 0, size / 2, size - 3} : std::vector<int64_t>{size / 2}) {
                fs::remove_all(folder_ / "cut");
                fs::copy(folder_ / experiment, folder_ / "cut", fs::copy_options::recursive);
                if (length < 0) fs::remove(folder_ / "cut" / file);
                else fs::resize_file(folder_ / "cut" / file, uintmax_t(length));
                SCOPED_TRACE(fmt::format("{} {} {}", experiment, file, length));
                const ExperimentOutcome outcome = Run(Settings("cut", samplers));
                ++cuts;
                ExpectSamePictures("whole", "cut", samplers, 2);
                for (size_t i = 0; i < samplers.size(); ++i) {
                    const Json &a = SamplerOf(whole, i), &b = SamplerOf(outcome, i);
                    EXPECT_EQ(a.at("summary").at("metrics"), b.at("summary").at("metrics"));
                    for (size_t seed = 0; seed < 2; ++seed) {
                        const Json &x = a.at("runs").at(seed).at("rounds"), &y = b.at("runs").at(seed).at("rounds");
                        ASSERT_EQ(x.size(), y.size());
                        for (size_t r = 0; r < x.size(); ++r) EXPECT_EQ(x.at(r).at("metrics"), y.at(r).at("metrics"));
                    }
                    for (const Json &layer : b.at("views").at("layers")) {
                        const std::string picture =
                            layer.at("file").is_string() ? layer.at("file") : "views/brightest.png";
                        EXPECT_NO_THROW(ReadImage(Path("cut/" + picture)));
                    }
                }
            }
        }
    }
    EXPECT_GE(films, 1);
    EXPECT_GE(cuts, 80);
}

TEST_F(Experiment, RecordsOfAnotherExperimentOrVersionAreNotReused) {
    Run(Settings("whole", {"uniform"}));
    ExperimentSettings settings = Settings("out", {"uniform"});
    settings.samplesPerPixel = 8;
    Run(settings);
    // The file with the settings of the records is lost, and the new settings differ.
    fs::remove(folder_ / "out/records/settings.json");
    EXPECT_EQ(SamplerOf(Run(Settings("out", {"uniform"})), 0).at("runs").at(0).at("rounds").size(), 3u);
    ExpectSamePictures("whole", "out", {"uniform"}, 2);
    // A record that lacks a value which this version needs.
    const fs::path record = folder_ / "out/records/uniform/seed1-round02.json";
    Json json = ReadJson(record);
    json.erase("shadowRays");
    json["metrics"]["relL2"] = 0;
    std::ofstream(record) << json;
    Run(Settings("out", {"uniform"}));
    EXPECT_EQ(ReadJson(record).at("metrics"),
              ReadJson(folder_ / "whole/records/uniform/seed1-round02.json").at("metrics"));
}

TEST_F(Experiment, MoreSeedsResumeAndFewerAreAPart) {
    ExperimentSettings settings = Settings("out", {"uniform"});
    settings.seeds = 2;
    Run(settings);
    const auto time = fs::last_write_time(folder_ / "out/uniform/seed1.exr");
    settings.seeds = 3;
    const ExperimentOutcome more = Run(settings);
    EXPECT_EQ(fs::last_write_time(folder_ / "out/uniform/seed1.exr"), time);
    ExperimentSettings afresh = settings;
    afresh.outFolder = Path("afresh");
    EXPECT_EQ(SummaryOf(more, 0).at("metrics"), SummaryOf(Run(afresh), 0).at("metrics"));
    settings.seeds = 1;
    const ExperimentOutcome fewer = Run(settings);
    EXPECT_EQ(fewer.results.at("seeds"), 1);
    EXPECT_EQ(SamplerOf(fewer, 0).at("runs").size(), 1u);
}

TEST_F(Experiment, OtherSettingsInTheSameFolderAreErrorsUntilRestart) {
    ExperimentSettings settings = Settings("out", {"uniform"});
    Run(settings);
    settings.samplesPerPixel = 2;
    ExpectError([&] { Run(settings); }, {"spp", "4", "2", "--restart"});
    settings.restart = true;
    EXPECT_EQ(Run(settings).results.at("budget"), 2);
}

}  // namespace ext::lab
