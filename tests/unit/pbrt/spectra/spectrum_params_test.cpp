#include "pbrt/spectra/spectrum_params.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "support/errors.h"

namespace pbrt {
namespace {

class SpectrumParams : public ::testing::Test {
  protected:
    SpectrumParams() {
        file_ = std::make_shared<SourceFile>(SourceFile{"test.pbrt", "Material\n"});
        params_ = ParamSet("Material \"diffuse\"", Loc(1));
        folder_ = std::filesystem::temp_directory_path() / ("pbrt_spectra_" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    ~SpectrumParams() override { std::filesystem::remove_all(folder_); }

    FileLoc Loc(int line) const { return {file_, line, 4}; }
    Param &Make(ParamType type, int line = 7) {
        made_ = Param();
        made_.type = type;
        made_.name = "x";
        made_.loc = Loc(line);
        return made_;
    }
    void AddFloats(ParamType type, std::vector<Float> values, int line = 7) {
        Make(type, line).floats = std::move(values);
        params_.Add(made_);
    }
    void AddName(const std::string &name) {
        Make(ParamType::Spectrum).strings = {name};
        params_.Add(made_);
    }
    void WriteFile(const std::string &name, const std::string &text) { std::ofstream(folder_ / name) << text; }
    SpectrumPtr Get(SpectrumUse use = SpectrumUse::Albedo) { return Get(SpectrumParam{use}); }
    SpectrumPtr Get(SpectrumParam param) {
        ParamReader reader(params_);
        ReadParam(reader, "x", param);
        return param.Make(FileResolver(folder_));
    }
    /// The message of the error that Get throws; checks that it points at line 7.
    std::string Failure(SpectrumUse use = SpectrumUse::Albedo) {
        const Diagnostic error = test::ErrorOf([&] { Get(use); });
        EXPECT_EQ(error.loc.line, 7);
        EXPECT_NE(error.message, "") << "nothing was thrown";
        return error.message;
    }

    std::shared_ptr<const SourceFile> file_;
    ParamSet params_;
    Param made_;
    std::filesystem::path folder_;
};

TEST_F(SpectrumParams, AbsentGivesTheDefault) {
    EXPECT_EQ(Get(), nullptr);
    EXPECT_EQ((*Get({SpectrumUse::Unbounded, Float(3)}))(500), 3);
    EXPECT_EQ(Get({SpectrumUse::Unbounded, {}, "metal-Cu-k"}), NamedSpectrum("metal-Cu-k"));
}

TEST_F(SpectrumParams, RgbIsUpliftedByUse) {
    AddFloats(ParamType::Rgb, {0.5f, 0.5f, 0.5f});
    EXPECT_NEAR((*Get(SpectrumUse::Albedo))(500), 0.5f, 1e-5);
    EXPECT_NEAR((*Get(SpectrumUse::Unbounded))(500), 0.5f, 1e-5);
    EXPECT_NEAR((*Get(SpectrumUse::Illuminant))(500), 0.5f * ColorSpace::SRGB().Illuminant()(500), 1e-5);
    EXPECT_TRUE(std::dynamic_pointer_cast<const RgbIlluminantSpectrum>(Get(SpectrumUse::Illuminant)));
}

TEST_F(SpectrumParams, RgbUsesTheColorSpaceOfItsPlace) {
    Make(ParamType::Rgb).floats = {0.7f, 0.25f, 0.15f};
    made_.colorSpace = "rec2020";
    params_.Add(made_);
    RgbAlbedoSpectrum wanted(*ColorSpace::Find("rec2020"), {0.7f, 0.25f, 0.15f});
    EXPECT_EQ((*Get())(610), wanted(610));
}

TEST_F(SpectrumParams, NegativeRgbIsAnError) {
    AddFloats(ParamType::Rgb, {1, -1, 1});
    test::ExpectWords(Failure(SpectrumUse::Illuminant), {"negative"});
}

TEST_F(SpectrumParams, InfiniteRgbIsAnError) {
    AddFloats(ParamType::Rgb, {1, 0, Infinity});
    for (SpectrumUse use : {SpectrumUse::Albedo, SpectrumUse::Unbounded, SpectrumUse::Illuminant})
        test::ExpectWords(Failure(use), {"infinite or not a number"});
}

TEST_F(SpectrumParams, NegativeSamplesAreAnErrorForIlluminants) {
    AddFloats(ParamType::Spectrum, {400, 0, 500, -1, 700, 1});
    EXPECT_TRUE(Get(SpectrumUse::Unbounded));
    test::ExpectWords(Failure(SpectrumUse::Illuminant), {"the value at 500 nm is -1"});
}

TEST_F(SpectrumParams, AlbedoAboveOneIsAnErrorForAlbedosOnly) {
    AddFloats(ParamType::Rgb, {1.2f, 0.5f, 0.5f});
    EXPECT_TRUE(Get(SpectrumUse::Unbounded));
    test::ExpectWords(Failure(), {"above 1"});
}

TEST_F(SpectrumParams, RgbTakesThreeValues) {
    AddFloats(ParamType::Rgb, {1, 1});
    test::ExpectWords(Failure(), {"takes 3 values, found 2"});
}

TEST_F(SpectrumParams, Blackbody) {
    AddFloats(ParamType::Blackbody, {5000});
    EXPECT_NEAR((*Get())(2.8977721e6f / 5000), 1, 1e-5);
    AddFloats(ParamType::Blackbody, {5000, 1});
    test::ExpectWords(Failure(), {"takes 1 value, found 2"});
    AddFloats(ParamType::Blackbody, {0});
    test::ExpectWords(Failure(), {"above 0"});
}

TEST_F(SpectrumParams, SamplesAreLinearAndZeroOutside) {
    AddFloats(ParamType::Spectrum, {400, 0.5f, 500, 1});
    SpectrumPtr s = Get();
    EXPECT_NEAR((*s)(450), 0.75f, 1e-6);
    EXPECT_EQ((*s)(399), 0.0f);
    EXPECT_EQ((*s)(501), 0.0f);
}

TEST_F(SpectrumParams, OddSampleCountIsAnError) {
    AddFloats(ParamType::Spectrum, {400, 0.5f, 700});
    test::ExpectWords(Failure(), {"odd number of values"});
}

TEST_F(SpectrumParams, UnsortedWavelengthsAreAnError) {
    AddFloats(ParamType::Spectrum, {400, 0.5f, 400, 1});
    test::ExpectWords(Failure(), {"must increase"});
}

TEST_F(SpectrumParams, NamesAndFiles) {
    AddName("glass-BK7");
    EXPECT_EQ(Get(), NamedSpectrum("glass-BK7"));
    WriteFile("s.spd", "# heading 1 2\n400 .5 # trailing\n  500\t1e0\n");
    AddName("s.spd");
    EXPECT_NEAR((*Get())(450), 0.75f, 1e-6);
    AddName("glass-BK8");
    test::ExpectWords(Failure(), {"glass-BK7"});
    WriteFile("odd.spd", "400 1 500\n");
    AddName("odd.spd");
    test::ExpectWords(Failure(), {"odd number of values"});
    WriteFile("word.spd", "400 1\n500 red\n");
    AddName("word.spd");
    test::ExpectWords(Failure(), {"word.spd:2"});
    WriteFile("empty.spd", "# nothing\n");
    AddName("empty.spd");
    test::ExpectWords(Failure(), {"no samples"});
}

TEST_F(SpectrumParams, FloatOnlyWhereAllowed) {
    AddFloats(ParamType::Float, {1.5f});
    EXPECT_EQ(Get(), nullptr);
    SpectrumPtr s = Get({SpectrumUse::Unbounded, {}, nullptr, true});
    ASSERT_TRUE(s);
    EXPECT_TRUE(s->IsConstant());
    EXPECT_EQ((*s)(700), 1.5f);
}

TEST_F(SpectrumParams, TwoTypesOfOneNameContradict) {
    AddFloats(ParamType::Rgb, {0.5f, 0.5f, 0.5f}, 6);
    AddFloats(ParamType::Spectrum, {400, 1, 500, 1});
    test::ExpectWords(Failure(), {"given both"});
}

TEST_F(SpectrumParams, OwnValueBeatsAttributeDefaultOfAnotherType) {
    Make(ParamType::Rgb).floats = {0.5f, 0.5f, 0.5f};
    params_.AddDefault(made_);
    EXPECT_NEAR((*Get())(500), 0.5f, 1e-5);
    AddFloats(ParamType::Spectrum, {400, 1, 600, 1});
    EXPECT_EQ((*Get())(500), 1.0f);
}

TEST_F(SpectrumParams, LaterAttributeDefaultWins) {
    Make(ParamType::Spectrum, 3).floats = {400, 1, 600, 1};
    params_.AddDefault(made_);
    Make(ParamType::Rgb, 4).floats = {0.5f, 0.5f, 0.5f};
    params_.AddDefault(made_);
    EXPECT_NEAR((*Get())(500), 0.5f, 1e-5);
    Make(ParamType::Blackbody, 5).floats = {5000};
    params_.AddDefault(made_);
    EXPECT_NEAR((*Get())(2.8977721e6f / 5000), 1, 1e-5);
}

}  // namespace
}  // namespace pbrt
