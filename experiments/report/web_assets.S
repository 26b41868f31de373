// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the files of the page into the program. The build defines the paths of the files.
.section .rodata

.globl shearcell_page, shearcell_page_end
shearcell_page:
.incbin SHEARCELL_PAGE_FILE
shearcell_page_end:

.globl shearcell_style, shearcell_style_end
shearcell_style:
.incbin SHEARCELL_STYLE_FILE
shearcell_style_end:

.globl shearcell_script, shearcell_script_end
shearcell_script:
.incbin SHEARCELL_SCRIPT_FILE
shearcell_script_end:

.globl shearcell_licences, shearcell_licences_end
shearcell_licences:
.incbin SHEARCELL_LICENCES_FILE
shearcell_licences_end:
.byte 0

.section .note.GNU-stack, "", %progbits
