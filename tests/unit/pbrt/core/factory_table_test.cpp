#include "pbrt/core/factory_table.h"

#include <gtest/gtest.h>

#include "support/errors.h"
#include "support/given_params.h"

namespace pbrt {
namespace {

struct Context {
    DiagnosticSink &sink;
};
using Table = FactoryTable<int, const Context>;

struct TwiceParams {
    int n = 4;
    template <class V>
    void Describe(V &&v) {
        v("n", n, Range{0, 9}, "half of what is made");
    }
};

Table MakeTable() {
    Table table("Number");
    table.Add<TwiceParams>("twice", "an even number",
                           [](const TwiceParams &p, const ParamSet &, const Context &) { return 2 * p.n; });
    table.Add<NoParams>("one", "", [](NoParams, const ParamSet &, const Context &) { return 1; });
    return table;
}

/// The directive is at line 5, the parameter at line 6.
ParamSet Given(const char *name, int value) { return test::Params("Number \"twice\"", 5).Integer(name, value).Set(); }

TEST(FactoryTable, MakesByNameFromDeclaredParameters) {
    DiagnosticSink sink;
    const Table table = MakeTable();
    EXPECT_EQ(table.Names(), (std::vector<std::string>{"one", "twice"}));
    EXPECT_EQ(table.Make("twice", Given("n", 3), Context{sink}), 6);
    EXPECT_EQ(table.Make("twice", ParamSet(), Context{sink}), 8);
    EXPECT_EQ(table.Make("one", ParamSet(), Context{sink}), 1);
    EXPECT_TRUE(sink.All().empty());
}

TEST(FactoryTable, WhatIsNotDeclaredGoesToTheSinkAndBadValuesAreThrown) {
    DiagnosticSink sink;
    EXPECT_EQ(MakeTable().Make("twice", Given("m", 3), Context{sink}), 8);
    ASSERT_EQ(sink.ErrorCount(), 1u);
    EXPECT_EQ(sink.All()[0].loc.line, 6);
    EXPECT_THROW(MakeTable().Make("twice", Given("n", 10), Context{sink}), UserError);
}

TEST(FactoryTable, AnUnknownNameListsTheChoices) {
    DiagnosticSink sink;
    test::ExpectErrorAt([&] { MakeTable().Make("twise", Given("n", 1), Context{sink}); }, 5,
                        {"Number \"twise\"", "\"twice\"", "one, twice"});
}

TEST(FactoryTable, ANameUsedTwiceIsOurError) {
    Table table = MakeTable();
    const auto two = [](NoParams, const ParamSet &, const Context &) { return 2; };
    EXPECT_THROW(table.Add<NoParams>("one", "", two), std::logic_error);
}

/// The context of a maker whose parameter set has parameters that another reader reads.
struct ContextAfter {
    DiagnosticSink &sink;
    const ParamReader &before;
};

TEST(FactoryTable, WhatAnotherReaderHasDeclaredIsNotUnused) {
    FactoryTable<int, const ContextAfter> table("Number");
    table.Add<NoParams>("one", "", [](NoParams, const ParamSet &, const ContextAfter &) { return 1; });
    DiagnosticSink sink;
    const ParamSet set = Given("n", 3);
    ParamReader before(set);
    TwiceParams other;
    other.Describe(before);
    table.Make("one", set, ContextAfter{sink, before});
    EXPECT_FALSE(sink.HasErrors());
    table.Make("one", set, ContextAfter{sink, ParamReader(set)});
    EXPECT_TRUE(sink.HasErrors());
}

TEST(FactoryTable, WithoutASinkParametersHaveAnOwner) {
    FactoryTable<int, const int> table("Number");
    table.Add<TwiceParams>("twice", "",
                           [](const TwiceParams &p, const ParamSet &, int more) { return 2 * p.n + more; });
    const ParamSet own = Given("twice.n", 3), other = Given("n", 3), bad = Given("twice.n", 10);
    EXPECT_EQ(table.Make("twice", own, 1), 7);
    EXPECT_EQ(table.Make("twice", other, 1), 9) << "parameters of other owners are ignored";
    table.Find("twice").check(own);
    EXPECT_THROW(table.Find("twice").check(bad), UserError);
    EXPECT_THROW(table.Make("twice", bad, 1), UserError);
    test::ExpectWords(ListingOf(table.Document("numbers")), {"integer twice.n = 4"});
}

TEST(FactoryTable, ListsAndTablesNameEverything) {
    const FamilyDoc doc = MakeTable().Document("numbers");
    EXPECT_EQ(ListingOf(doc),
              "one\n    No parameters.\n\ntwice\n    an even number\n    integer n = 4 (0 to 9)\n"
              "        half of what is made\n");
    EXPECT_EQ(TableRowsOf(doc), "| `Number \"one\"` | | |\n| `Number \"twice\"` | `i n` | an even number |\n");
}

TEST(FactoryTable, ListingsHaveNoMarkup) {
    const FamilyDoc doc{"numbers", "Number", false, {{"one", "**differs**: [x](#y); see [page.md](../page.md)", {}}}};
    test::ExpectWords(ListingOf(doc), {"    differs: x in docs/", "; see page.md\n"});
    test::ExpectWords(TableRowsOf(doc), {"**differs**: [x](#y)"});
}

}  // namespace
}  // namespace pbrt
