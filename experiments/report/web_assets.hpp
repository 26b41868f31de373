// SPDX-License-Identifier: GPL-3.0-or-later
// Files of the front end that are part of the program (web_assets.S).
#pragma once

#include <string_view>

namespace shearcell {

std::string_view page_style();
/// Empty when it was built without Node.
std::string_view front_end_script();
/// Of the libraries in the script.
std::string_view front_end_licences();

}  // namespace shearcell
