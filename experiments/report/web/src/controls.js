// SPDX-License-Identifier: GPL-3.0-or-later
// The markup of the packing viewer; viewer.js and pane.js find its parts by `data-part`.

export const controls = `<div class="controls">
<label>Run <select data-part="run"></select></label>
<label>Colour <select data-part="colour"><option value="class">FCC, HCP, disordered</option>
<option value="crystallite">crystallites</option><option value="phi">local volume fraction</option>
<option value="q6">bond order q6</option>
<option value="lattice">lattice by common neighbours</option>
<option value="pressure">pressure</option><option value="contacts">contacts</option>
<option value="overlap">largest overlap</option>
<option value="displacement">displacement in a cycle</option>
<option value="d2min">non-affine motion in a cycle</option></select></label>
<label>Profile <select data-part="profile"><option value="none">none</option>
<option value="phi">volume fraction</option><option value="pressure">pressure</option>
<option value="coordination">contacts per grain</option>
<option value="crystalline">crystalline</option></select></label>
<label>Disordered <select data-part="disordered"><option value="full">full size</option>
<option value="small">small</option><option value="hidden">hidden</option></select></label>
<label>Clip <select data-part="cut-axis"><option value="none">nothing</option>
<option value="x">along x</option><option value="y">along y</option>
<option value="z">along z</option></select></label>
<label class="grow">at <input type="range" data-part="cut-at" min="0" max="1000" value="500">
<output data-part="cut-text"></output></label>
<label><input type="checkbox" data-part="cut-side"> other side</label>
<label><input type="checkbox" data-part="walls" checked> wall grains</label>
<label><input type="checkbox" data-part="box" checked> cell</label>
</div>
<p class="warning" data-part="trouble" hidden>This browser has no WebGL 2, so packings cannot be shown.</p>
<div class="panes" data-part="panes"></div>
<div class="timeline">
<button type="button" data-part="play">Play</button>
<label class="grow"><span class="visually-hidden">Checkpoint</span>
<input type="range" data-part="cycle" min="0" max="0" step="1" value="0"></label>
<output data-part="cycle-text"></output>
</div>
<p><button type="button" data-part="reset">First view</button>
<button type="button" data-part="save">Save PNG</button></p>
`;

export const pane = `<div class="stage3d" data-part="stage">
<canvas data-part="canvas" tabindex="0" role="img" aria-label="The packing. Arrow keys turn it, plus and minus zoom, 0 shows all."></canvas>
<div class="key3d" data-part="key"></div>
<svg class="profile" data-part="profile-line" role="img" hidden></svg>
</div>
<p class="facts"><span data-part="facts"></span> <span>checkpoint <code data-part="checkpoint"></code></span></p>
<p class="facts" data-part="grain" role="status"></p>
`;
