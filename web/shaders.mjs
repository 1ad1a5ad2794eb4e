// Of the shaders of three.js, a seventh of its text, the page keeps those that its materials are drawn with.

/** By the names of three.js: MeshLambertMaterial, LineBasicMaterial, SpriteMaterial of web/src/scene. */
const drawn = ['meshlambert', 'meshbasic', 'sprite'];

/** What three.js puts into each of them besides. */
const common = ['colorspace_pars_fragment'];

/** What no material, light or scene of the page turns on. */
const never = [
  ...['ALPHAHASH', 'ALPHAMAP', 'ALPHATEST', 'AOMAP', 'BATCHING', 'BUMPMAP', 'DISPLACEMENTMAP', 'EMISSIVEMAP', 'ENVMAP', 'FOG'],
  ...['INSTANCING', 'INSTANCING_MORPH', 'LIGHTMAP', 'LIGHT_PROBES', 'LOGARITHMIC_DEPTH_BUFFER', 'MORPHCOLORS', 'MORPHNORMALS'],
  ...['MORPHTARGETS', 'NORMALMAP', 'SHADOWMAP', 'SKINNING', 'SPECULARMAP', 'TRANSMISSION'],
].map((name) => `USE_${name}`);
const none = [
  ...['CLIPPING_PLANES', 'DIR_LIGHT_SHADOWS', 'LIGHT_PROBE_GRIDS', 'POINT_LIGHTS', 'POINT_LIGHT_SHADOWS', 'RECT_AREA_LIGHTS'],
  ...['SPOT_LIGHTS', 'SPOT_LIGHT_COORDS', 'SPOT_LIGHT_MAPS', 'SPOT_LIGHT_SHADOWS'],
].map((name) => `NUM_${name}`);
const isOff = (line) => {
  const name = /^#ifdef (\w+)$/.exec(line)?.[1] ?? /^#if defined\( (\w+) \)(?: && [^|]*)?$/.exec(line)?.[1];
  const count = /^#if \(? ?(\w+) > 0 ?\)?(?: && [^|]*)?$/.exec(line)?.[1];
  return never.includes(name) || none.includes(count);
};

/** A shader without the branches that are never compiled. */
function compiled(text) {
  const kept = [];
  const open = []; // per #if whether it is one of those, and whether this is its branch
  for (const line of text.split('\n')) {
    const [, directive, rest] = /^\s*#(if|elif|else|endif)(.*)/.exec(line) ?? [];
    if (directive === 'if') open.push({ off: isOff(line.trim()), branch: true });
    const last = open.at(-1);
    const written = directive === 'elif' && last.off ? `#if${rest}` : line;
    if (directive === 'elif') last.off = false;
    if (directive === 'else') last.branch = false;
    if (!open.some(({ off, branch }) => off && branch) && !(directive && last.off)) kept.push(written);
    if (directive === 'endif') open.pop();
  }
  return kept.join('\n');
}

/** The text of build/three.module.js without the other shaders. */
export function withoutOtherShaders(source) {
  const chunk = /^var (\w+) = (".*");$/gm; // parts, by their names in #include
  const whole = /^const ((?:vertex|fragment)\$?\w*) = (".*");$/gm;
  const parts = new Map([...source.matchAll(chunk)].map(([, name, text]) => [name, compiled(JSON.parse(text))]));
  const shaders = new Map([...source.matchAll(whole)].map(([, name, text]) => [name, compiled(JSON.parse(text))]));
  const variables = new Map([...source.matchAll(/^\t(\w+_(?:vert|frag)): (\S+?),?$/gm)].map(([, name, variable]) => [name, variable]));
  const kept = new Set();
  const keep = (variable, text) => {
    if (text === undefined) throw new Error(`three.js has no shader ${variable}: web/shaders.mjs knows another version`);
    kept.add(variable);
    for (const [, name] of text.matchAll(/#include <(\w+)>/g)) if (!kept.has(name)) keep(name, parts.get(name));
  };
  for (const name of drawn)
    for (const of of ['vert', 'frag']) {
      const variable = variables.get(`${name}_${of}`);
      keep(variable, shaders.get(variable));
    }
  const text = (all) => (found, name) => found.replace(/".*"/, () => JSON.stringify(kept.has(name) ? all.get(name) : ''));
  for (const name of common) keep(name, parts.get(name));
  return source.replace(chunk, text(parts)).replace(whole, text(shaders));
}
