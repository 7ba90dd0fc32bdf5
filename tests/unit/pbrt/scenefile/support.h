#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "pbrt/core/param_reader.h"
#include "pbrt/scenefile/parser.h"
#include "support/parse_text.h"
#include "support/scene_text.h"

// In the texts and messages of these functions ' stands for ".
namespace pbrt::test {

/// A parsed scene and the messages about it.
struct Parsed {
    SceneDescription scene;
    DiagnosticSink sink;
};

inline Parsed Parse(const std::string &text) {
    Parsed parsed;
    parsed.scene = ParseSceneText(Quoted(text), parsed.sink, "test.pbrt");
    return parsed;
}

/// The value of a parameter of one number.
inline Float FloatOf(const ParamSet &params, const std::string &name, Float defaultValue) {
    ParamReader reader(params);
    reader(name, defaultValue, "");
    reader.ThrowIfErrors();
    return defaultValue;
}

/// Where the transformation at the start time puts the origin.
inline Point3 OriginOf(const TransformPair &ctm) { return ctm.start.Point({0, 0, 0}); }

inline std::string Messages(const DiagnosticSink &sink) {
    std::string all;
    for (const Diagnostic &d : sink.All()) all += Format(d) + "\n";
    return all;
}

/// Parses `text`, which must give no messages.
inline SceneDescription ParseClean(const std::string &text) {
    Parsed parsed = Parse(text);
    EXPECT_EQ("", Messages(parsed.sink)) << text;
    return std::move(parsed.scene);
}

/// Parses the world block `text` after a WorldBegin that stands alone on line 1.
inline SceneDescription ParseWorld(const std::string &text) { return ParseClean("WorldBegin\n" + text); }

struct Expected {
    Severity severity;
    int line, column;
    std::string part;  ///< a part of the message
};

inline void ExpectMessages(const DiagnosticSink &sink, const std::vector<Expected> &expected,
                           const std::string &about) {
    ASSERT_EQ(sink.All().size(), expected.size()) << about << "\n" << Messages(sink);
    for (size_t i = 0; i < expected.size(); ++i) {
        const Diagnostic &d = sink.All()[i];
        EXPECT_EQ(d.severity, expected[i].severity) << about << "\n" << Format(d);
        EXPECT_EQ(d.loc.line, expected[i].line) << about << "\n" << Format(d);
        EXPECT_EQ(d.loc.column, expected[i].column) << about << "\n" << Format(d);
        EXPECT_NE(d.message.find(Quoted(expected[i].part)), std::string::npos) << about << "\n" << Format(d);
    }
}

/// Expects that `text` gives exactly this one error.
inline void ExpectError(const std::string &text, int line, int column, const std::string &part) {
    ExpectMessages(Parse(text).sink, {{Severity::Error, line, column, part}}, text);
}

/// Expects that the world block `text`, whose first line is line 2, gives exactly this one error.
inline void ExpectWorldError(const std::string &text, int line, int column, const std::string &part) {
    ExpectError("WorldBegin\n" + text, line, column, part);
}

inline void ExpectWorldWarning(const std::string &text, int line, int column, const std::string &part) {
    ExpectMessages(Parse("WorldBegin\n" + text).sink, {{Severity::Warning, line, column, part}}, text);
}

}  // namespace pbrt::test
