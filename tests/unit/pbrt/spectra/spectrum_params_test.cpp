#include "pbrt/spectra/spectrum_params.h"

#include "support/errors.h"
#include "support/folder_test.h"
#include "support/given_params.h"

namespace pbrt::test {
namespace {

using enum SpectrumUse;

class SpectrumParams : public FolderTest {
  protected:
    SpectrumPtr Get(const ParamSet &params, SpectrumParam param = {Albedo}) {
        ParamReader reader(params);
        ReadParam(reader, "x", param);
        return param.Make(FileResolver(folder_));
    }
    /// The error of Get is at the parameter of number `line`.
    void ExpectFailure(const ParamSet &params, const std::string &word, SpectrumUse use = Albedo, int line = 1) {
        const Diagnostic error = ErrorOf([&] { Get(params, {use}); });
        EXPECT_EQ(error.loc.line, line) << error.message;
        ExpectWords(error.message, {word});
    }
    static Params Grey() { return Params().Rgb("x", 0.5f, 0.5f, 0.5f); }
    static Params Kelvin(std::vector<Float> values) {
        return Params().Floats(ParamType::Blackbody, "x", std::move(values));
    }
    static Params Named(const std::string &name) { return Params().NamedSpectrum("x", name); }
};

TEST_F(SpectrumParams, AbsentGivesTheDefault) {
    EXPECT_EQ(Get(Params()), nullptr);
    EXPECT_EQ((*Get(Params(), {Unbounded, Float(3)}))(500), 3);
    EXPECT_EQ(Get(Params(), {Unbounded, {}, "metal-Cu-k"}), NamedSpectrum("metal-Cu-k"));
}

TEST_F(SpectrumParams, RgbIsUpliftedByUse) {
    EXPECT_NEAR((*Get(Grey()))(500), 0.5f, 1e-5);
    EXPECT_NEAR((*Get(Grey(), {Unbounded}))(500), 0.5f, 1e-5);
    EXPECT_NEAR((*Get(Grey(), {Illuminant}))(500), 0.5f * ColorSpace::SRGB().Illuminant()(500), 1e-5);
    EXPECT_TRUE(std::dynamic_pointer_cast<const RgbIlluminantSpectrum>(Get(Grey(), {Illuminant})));
}

TEST_F(SpectrumParams, RgbUsesTheColorSpaceOfItsPlace) {
    Param p = FloatParam("x", {0.7f, 0.25f, 0.15f}, ParamType::Rgb);
    p.colorSpace = "rec2020";
    RgbAlbedoSpectrum wanted(*ColorSpace::Find("rec2020"), {0.7f, 0.25f, 0.15f});
    EXPECT_EQ((*Get(Params().Add(p)))(610), wanted(610));
}

TEST_F(SpectrumParams, WrongValuesAreErrorsOfTheUse) {
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
        const Params params = Params().Floats(c.type, "x", c.values);
        for (SpectrumUse use : c.uses) ExpectFailure(params, c.word, use);
        if (c.uses.size() == 1) {
            EXPECT_TRUE(Get(params, {Unbounded}));
        }
    }
}

TEST_F(SpectrumParams, Blackbody) {
    EXPECT_NEAR((*Get(Kelvin({5000})))(2.8977721e6f / 5000), 1, 1e-5);
    ExpectFailure(Kelvin({5000, 1}), "takes 1 value, found 2");
    ExpectFailure(Kelvin({0}), "above 0");
}

TEST_F(SpectrumParams, SamplesAreLinearAndZeroOutside) {
    SpectrumPtr s = Get(Params().Spectrum("x", {400, 0.5f, 500, 1}));
    EXPECT_NEAR((*s)(450), 0.75f, 1e-6);
    EXPECT_EQ((*s)(399), 0.0f);
    EXPECT_EQ((*s)(501), 0.0f);
}

TEST_F(SpectrumParams, NamesAndFiles) {
    EXPECT_EQ(Get(Named("glass-BK7")), NamedSpectrum("glass-BK7"));
    Write("s.spd", "# heading 1 2\n400 .5 # trailing\n  500\t1e0\n");
    EXPECT_NEAR((*Get(Named("s.spd")))(450), 0.75f, 1e-6);
    ExpectFailure(Named("glass-BK8"), "glass-BK7");
    Write("odd.spd", "400 1 500\n");
    ExpectFailure(Named("odd.spd"), "odd number of values");
    Write("word.spd", "400 1\n500 red\n");
    ExpectFailure(Named("word.spd"), "word.spd:2");
    Write("empty.spd", "# nothing\n");
    ExpectFailure(Named("empty.spd"), "no samples");
}

TEST_F(SpectrumParams, FloatOnlyWhereAllowed) {
    const Params params = Params().Number("x", 1.5f);
    EXPECT_EQ(Get(params), nullptr);
    SpectrumPtr s = Get(params, {Unbounded, {}, nullptr, true});
    ASSERT_TRUE(s);
    EXPECT_TRUE(s->IsConstant());
    EXPECT_EQ((*s)(700), 1.5f);
}

TEST_F(SpectrumParams, TwoTypesOfOneNameContradict) {
    ExpectFailure(Grey().Spectrum("x", {400, 1, 500, 1}), "given both", Albedo, 2);
}

TEST_F(SpectrumParams, OwnValueBeatsAttributeDefaultOfAnotherType) {
    Params params;
    params.Default(ParamType::Rgb, "x", {0.5f, 0.5f, 0.5f});
    EXPECT_NEAR((*Get(params))(500), 0.5f, 1e-5);
    EXPECT_EQ((*Get(params.Spectrum("x", {400, 1, 600, 1})))(500), 1.0f);
}

TEST_F(SpectrumParams, LaterAttributeDefaultWins) {
    Params params;
    params.Default(ParamType::Spectrum, "x", {400, 1, 600, 1}).Default(ParamType::Rgb, "x", {0.5f, 0.5f, 0.5f});
    EXPECT_NEAR((*Get(params))(500), 0.5f, 1e-5);
    params.Default(ParamType::Blackbody, "x", {5000});
    EXPECT_NEAR((*Get(params))(2.8977721e6f / 5000), 1, 1e-5);
}

}  // namespace
}  // namespace pbrt::test
