// SPDX-License-Identifier: GPL-3.0-or-later
// Texts do not become markup in a page.
#include "experiments/report/html.hpp"
#include "tests/support/text.hpp"

#include <gtest/gtest.h>

#include <map>

namespace shearcell::test {
namespace {

TEST(Html, EscapesMarkupAndCharactersThatAPageMayNotHold) {
  EXPECT_EQ(escape_html("<a href=\"x\" id='y'>&amp;</a>"),
            "&lt;a href=&quot;x&quot; id=&apos;y&apos;&gt;&amp;amp;&lt;/a&gt;");
  EXPECT_EQ(escape_html("ϕ = 0.64,\nline"), "ϕ = 0.64,\nline");
  EXPECT_EQ(escape_html(std::string("a\0b\x1b\x7f", 5)), "a\\x00b\\x1b\\x7f");
  EXPECT_EQ(escape_html("cut \xCF"), "cut \\xcf");
}

TEST(Html, ATemplateEscapesTextsAndReadsNoTagInThem) {
  const nlohmann::json values = {{"text", "<b>{{other}}</b>"},
                                 {"other", "x"},
                                 {"list", {"a", "b&"}},
                                 {"none", ""},
                                 {"count", 0}};
  EXPECT_EQ(filled("{{text}}|{{{text}}}|{{#list}}{{.}},{{/list}}|{{^none}}none{{/none}}|{{count}}",
                   values),
            "&lt;b&gt;{{other}}&lt;/b&gt;|<b>{{other}}</b>|a,b&amp;,|none|0");
  EXPECT_EQ(filled("{{#brief}}{{id}}{{/brief}}|{{#brief}}{{other}}{{/brief}}",
                   {{"id", "0123456789abcdef"}, {"other", "<"}}),
            "0123456789ab|&lt;");
  EXPECT_EQ(filled("{{#nothing}}x{{/nothing}}{{nothing}}", values), "");
  EXPECT_THROW(filled("{{#list}}", values), std::logic_error);
}

TEST(Html, JsonCannotEndItsScriptElement) {
  const nlohmann::json value = {{"</script><!--", "<script>&amp;\u2028]]>"}, {"n", 1.5}};
  const std::string text = script_json(value);
  EXPECT_EQ(text.find_first_of("<>&"), std::string::npos) << text;
  EXPECT_EQ(nlohmann::json::parse(text), value);
  EXPECT_TRUE(nlohmann::json::accept(script_json({{"not UTF-8", "\xFF\xFE"}})));
}

TEST(Html, Base64FollowsRfc4648) {
  for (const auto& [text, encoded] : std::map<std::string, std::string>{{"", ""},
                                                                        {"f", "Zg=="},
                                                                        {"fo", "Zm8="},
                                                                        {"foo", "Zm9v"},
                                                                        {"foob", "Zm9vYg=="},
                                                                        {"\xFB\xFF", "+/8="}}) {
    EXPECT_EQ(base64(std::as_bytes(std::span(text))), encoded);
  }
}

}  // namespace
}  // namespace shearcell::test
