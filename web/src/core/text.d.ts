// Put in by build.mjs: the worker as a script.
declare module 'core-worker' {
  const script: string;
  export default script;
}
