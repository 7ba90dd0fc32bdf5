#include "pbrt/spectra/spectrum_params.h"

#include "support/errors.h"
#include "support/folder_test.h"

namespace pbrt::test {
namespace {

class SpectrumParams : public FolderTest {
  protected:
    SpectrumParams() {
        file_ = std::make_shared<SourceFile>(SourceFile{"test.pbrt", "Material\n"});
        params_ = ParamSet("Material \"diffuse\"", Loc(1));
    }

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
    SpectrumPtr Get(SpectrumUse use = SpectrumUse::Albedo) { return Get(SpectrumParam{use}); }
    SpectrumPtr Get(SpectrumParam param) {
        ParamReader reader(params_);
        ReadParam(reader, "x", param);
        return param.Make(FileResolver(folder_));
    }
    /// The message of the error that Get throws; checks that it points at line 7.
    std::string Failure(SpectrumUse use = SpectrumUse::Albedo) {
        const Diagnostic error = ErrorOf([&] { Get(use); });
        EXPECT_EQ(error.loc.line, 7);
        EXPECT_NE(error.message, "") << "nothing was thrown";
        return error.message;
    }

    std::shared_ptr<const SourceFile> file_;
    ParamSet params_;
    Param made_;
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

TEST_F(SpectrumParams, WrongValuesAreErrorsOfTheUse) {
    using enum SpectrumUse;
    struct Case {
        ParamType type;
        std::vector<Float> values;
        std::vector<SpectrumUse> uses;  ///< that do not accept the values
        std::string word;
    };
    const std::vector<SpectrumUse> all = {Albedo, Unbounded, Illuminant};
    for (const Case &c : {Case{ParamType::Rgb, {1, -1, 1}, all, "negative"},
                          {ParamType::Rgb, {1, 0, Infinity}, all, "infinite or not a number"},
                          {ParamType::Rgb, {1, 1}, all, "takes 3 values, found 2"},
                          {ParamType::Rgb, {1.2f, 0.5f, 0.5f}, {Albedo}, "above 1"},
                          {ParamType::Spectrum, {400, 0, 500, -1, 700, 1}, {Illuminant}, "the value at 500 nm is -1"},
                          {ParamType::Spectrum, {400, 0.5f, 700}, all, "odd number of values"},
                          {ParamType::Spectrum, {400, 0.5f, 400, 1}, all, "must increase"}}) {
        SCOPED_TRACE(c.word);
        const ParamSet none = params_;
        AddFloats(c.type, c.values);
        for (SpectrumUse use : c.uses) ExpectWords(Failure(use), {c.word});
        if (c.uses.size() == 1) {
            EXPECT_TRUE(Get(Unbounded));
        }
        params_ = none;
    }
}

TEST_F(SpectrumParams, Blackbody) {
    AddFloats(ParamType::Blackbody, {5000});
    EXPECT_NEAR((*Get())(2.8977721e6f / 5000), 1, 1e-5);
    AddFloats(ParamType::Blackbody, {5000, 1});
    ExpectWords(Failure(), {"takes 1 value, found 2"});
    AddFloats(ParamType::Blackbody, {0});
    ExpectWords(Failure(), {"above 0"});
}

TEST_F(SpectrumParams, SamplesAreLinearAndZeroOutside) {
    AddFloats(ParamType::Spectrum, {400, 0.5f, 500, 1});
    SpectrumPtr s = Get();
    EXPECT_NEAR((*s)(450), 0.75f, 1e-6);
    EXPECT_EQ((*s)(399), 0.0f);
    EXPECT_EQ((*s)(501), 0.0f);
}

TEST_F(SpectrumParams, NamesAndFiles) {
    AddName("glass-BK7");
    EXPECT_EQ(Get(), NamedSpectrum("glass-BK7"));
    Write("s.spd", "# heading 1 2\n400 .5 # trailing\n  500\t1e0\n");
    AddName("s.spd");
    EXPECT_NEAR((*Get())(450), 0.75f, 1e-6);
    AddName("glass-BK8");
    ExpectWords(Failure(), {"glass-BK7"});
    Write("odd.spd", "400 1 500\n");
    AddName("odd.spd");
    ExpectWords(Failure(), {"odd number of values"});
    Write("word.spd", "400 1\n500 red\n");
    AddName("word.spd");
    ExpectWords(Failure(), {"word.spd:2"});
    Write("empty.spd", "# nothing\n");
    AddName("empty.spd");
    ExpectWords(Failure(), {"no samples"});
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
    ExpectWords(Failure(), {"given both"});
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
}  // namespace pbrt::test
