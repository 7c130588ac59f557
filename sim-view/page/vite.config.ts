import { defineConfig } from "vite";

// Builds one script and one style sheet with fixed names and no other files, so that the server can inline both into
// one file.
export default defineConfig({
  base: "./",
  build: {
    target: "es2022",
    modulePreload: false,
    cssCodeSplit: false,
    assetsInlineLimit: Number.MAX_SAFE_INTEGER,
    chunkSizeWarningLimit: 1500,
    rollupOptions: {
      output: {
        entryFileNames: "page.js",
        assetFileNames: "page[extname]",
        inlineDynamicImports: true,
      },
    },
  },
  server: {
    // For `npm run dev` beside a running `eyesim view --port 7700`.
    proxy: {
      "/ws": { target: "http://127.0.0.1:7700", ws: true, changeOrigin: true, rewriteWsOrigin: true },
      "/files": "http://127.0.0.1:7700",
      "/recording.json": "http://127.0.0.1:7700",
    },
  },
});
