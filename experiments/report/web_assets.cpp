// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/web_assets.hpp"

extern "C" {
extern const char shearcell_style[], shearcell_style_end[];
extern const char shearcell_script[], shearcell_script_end[];
extern const char shearcell_licences[], shearcell_licences_end[];
}

namespace shearcell {

std::string_view page_style() {
  return {shearcell_style, shearcell_style_end};
}

std::string_view front_end_script() {
  return {shearcell_script, shearcell_script_end};
}

std::string_view front_end_licences() {
  return {shearcell_licences, shearcell_licences_end};
}

}  // namespace shearcell
