// SPDX-License-Identifier: GPL-3.0-or-later
// The target test_headers, which holds the precompiled headers, needs a source file.
